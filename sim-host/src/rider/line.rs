//! Linear regression of gains over speed.

use super::Gains;

/// A straight line per gain, `slope * speed + intercept`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Slope of the gains per m/s.
    pub slope: Gains,
    /// Gains at zero speed.
    pub intercept: Gains,
}

impl Line {
    /// The gains at `speed` \[m/s\].
    pub fn at(&self, speed: f64) -> Gains {
        Gains(std::array::from_fn(|i| self.slope.0[i] * speed + self.intercept.0[i]))
    }
}
