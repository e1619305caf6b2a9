//! Frequency and decay of the weave, measured: from a recording of the gyro after a knock to an eigenvalue with
//! its confidence interval.
//!
//! `record` reads a file, `label` what its name says, `window` finds the motion after the knock, `fit` fits
//! it (`shape`, `noise`), `segment` does all of that for one recording, `pool` puts repeats together, `predict` has the
//! linear model's answer, and `measured` is the table that is kept.

pub mod fit;
pub mod label;
pub mod measured;
pub mod noise;
pub mod pool;
pub mod predict;
pub mod record;
pub mod segment;
pub mod shape;
pub(crate) mod student;
pub mod window;

/// A number with its 95 % confidence interval.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl Estimate {
    /// The number whose interval is `quantile` standard errors wide on either side.
    pub fn new(value: f64, standard_error: f64, quantile: f64) -> Self {
        let half = quantile * standard_error;
        Self { value, standard_error, low: value - half, high: value + half }
    }

    /// Whether the interval holds `x`.
    pub fn holds(&self, x: f64) -> bool {
        (self.low..=self.high).contains(&x)
    }
}
