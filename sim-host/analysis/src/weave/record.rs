//! A recording of rates over time.

/// A column of rates.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Its name.
    pub column: String,
    /// The rates \[rad/s\].
    pub rates_rad_s: Vec<f64>,
}

/// A recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Sample times, increasing from 0 \[s\].
    pub times_s: Vec<f64>,
    /// The rates.
    pub axes: Vec<Axis>,
    /// Lines left out, with the reason.
    pub notes: Vec<String>,
}
