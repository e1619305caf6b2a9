//! Measures frequency and decay of the weave: from gyro samples after a disturbance to an eigenvalue with its confidence
//! interval.
//!
//! `window` finds the motion after the disturbance, and `fit` fits it (`shape`, `noise`). `segment` does this for one
//! recording, `pool` combines repeats, and `predict` computes the linear model's weave.

pub mod fit;
pub mod noise;
pub mod pool;
pub mod predict;
pub mod record;
pub mod segment;
pub mod shape;
pub mod student;
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
    /// Estimate with an interval of `quantile` standard errors to either side.
    pub fn new(value: f64, standard_error: f64, quantile: f64) -> Self {
        let half = quantile * standard_error;
        Self { value, standard_error, low: value - half, high: value + half }
    }

    /// Whether the interval contains `x`.
    pub fn holds(&self, x: f64) -> bool {
        (self.low..=self.high).contains(&x)
    }
}
