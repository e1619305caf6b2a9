//! Errors of a rider model: of its values and of its schedule.

use crate::range::RangeError;

/// A rider that can't be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UnfitError {
    /// A value outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// The delay is not a whole number of steps.
    #[error(
        "neural delay {} ms is not a whole number of steps of {} ms; nearest are {} and {}",
        .delay_s * 1e3, .step_s * 1e3, whole_ms((.delay_s / .step_s).floor(), *.step_s),
        whole_ms((.delay_s / .step_s).ceil(), *.step_s)
    )]
    Steps {
        /// The delay \[s\].
        delay_s: f64,
        /// The time step \[s\].
        step_s: f64,
    },
}

fn whole_ms(steps: f64, step_s: f64) -> String {
    format!("{} ms", steps * step_s * 1e3)
}

/// Gains that are no schedule over speed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScheduleError {
    /// A value outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// The speeds do not increase.
    #[error("speed {speed_m_s} m/s after {before_m_s} m/s: speeds must rise by at least 0.001")]
    Order {
        /// A speed \[m/s\].
        speed_m_s: f64,
        /// The speed before it \[m/s\].
        before_m_s: f64,
    },
    /// Nothing says which set of a group is its best.
    #[error(
        "the best of the {sets} sets at about {speed_m_s} m/s is unknown; the table needs the column `vaf`, or `best_runs`"
    )]
    NoBest {
        /// Number of sets in the group.
        sets: usize,
        /// Speed of the first \[m/s\].
        speed_m_s: f64,
    },
}
