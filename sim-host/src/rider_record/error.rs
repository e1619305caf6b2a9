//! Records that can't be used.

use crate::range::RangeError;

/// A record that can't be used for an identification.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// A signal without which there is no identification.
    #[error("no {what}: there is no column {columns}, and no map that names another")]
    Missing {
        /// The signal.
        what: &'static str,
        /// The documented columns.
        columns: &'static str,
    },
    /// Too few samples.
    #[error("{what} has {samples} usable samples; at least 100 are needed")]
    Few {
        /// The signal.
        what: &'static str,
        /// The number of samples.
        samples: usize,
    },
    /// A rate outside of the range.
    #[error(
        "the sample rate is {rate_hz:.4} Hz, from the median time between two samples; it must be 20 to 2000 Hz"
    )]
    Rate {
        /// The rate \[Hz\].
        rate_hz: f64,
    },
    /// Too long.
    #[error(
        "the record is {duration_s:.0} s long at {rate_hz:.0} Hz; at most 2,000,000 samples can be fitted"
    )]
    Long {
        /// Duration \[s\].
        duration_s: f64,
        /// Sample rate \[Hz\].
        rate_hz: f64,
    },
    /// More gaps than data.
    #[error("{what}: {missing} of {samples} samples are missing; at most half may be")]
    Gaps {
        /// The signal.
        what: &'static str,
        /// Missing samples.
        missing: usize,
        /// All samples.
        samples: usize,
    },
    /// No speed.
    #[error("no forward speed: there is no column speed_m_s; give it with --speed")]
    NoSpeed,
    /// A speed outside of the range.
    #[error(transparent)]
    Range(#[from] RangeError),
}
