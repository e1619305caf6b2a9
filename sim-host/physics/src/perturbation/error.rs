//! Errors of a perturbation record.

use crate::range::RangeError;
use crate::ride::{ConditionsError, FallCause};

/// A perturbation record that cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PerturbationError {
    /// A value outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// The rider cannot be simulated.
    #[error(transparent)]
    Conditions(#[from] ConditionsError),
    /// No time step from 0.01 to 0.25 ms divides the neural delay and the time between samples.
    #[error(
        "no step from 0.01 to 0.25 ms divides both the neural delay of {} ms and the {} ms from sample to sample", 
        .delay_s * 1e3, .sample_s * 1e3
    )]
    Step {
        /// The delay \[s\].
        delay_s: f64,
        /// The time from sample to sample \[s\].
        sample_s: f64,
    },
    /// The bicycle fell.
    #[error("the bicycle fell after {time_s:.3} s; a weaker pulse or another speed may keep it upright")]
    Fall {
        /// Time of the fall \[s\].
        time_s: f64,
        /// Its cause.
        cause: FallCause,
    },
}
