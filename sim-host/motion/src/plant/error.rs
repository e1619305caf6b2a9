//! Errors of the plant's values.

use crate::range::RangeError;

/// A plant that can't be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlantError {
    /// A value outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// Two random delays in the wrong order.
    #[error("{sensor} jitter: the largest is below that of 99 in 100 samples")]
    Jitter {
        /// Name of the sensor.
        sensor: &'static str,
    },
    /// Pulses of a sensor that is no wheel.
    #[error("{sensor} pulses per turn: only wheels have pulses")]
    Pulses {
        /// Name of the sensor.
        sensor: &'static str,
    },
}

impl PlantError {
    /// The error, with the key of its value in a scenario.
    pub(super) fn of(self, key: &'static str) -> Self {
        match self {
            Self::Range(error) => Self::Range(RangeError { key: Some(key), ..error }),
            other => other,
        }
    }
}
