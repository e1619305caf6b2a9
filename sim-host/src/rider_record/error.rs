//! Records that can't be used.

use crate::range::{RangeError, plain};

/// Fewest samples of a signal.
pub(super) const FEWEST: usize = 100;
/// Sample rates that can be fitted \[Hz\].
pub(super) const RATES_HZ: (f64, f64) = (20.0, 2000.0);
/// Units of time that loggers write, and their number in a second.
const UNITS: [(&str, f64); 3] = [("milliseconds", 1e3), ("microseconds", 1e6), ("nanoseconds", 1e9)];

/// The unit in which the times would make a usable rate, as a question.
fn question(rate_hz: f64) -> String {
    let usable = |rate_hz: f64| (RATES_HZ.0..=RATES_HZ.1).contains(&rate_hz);
    let unit = |(name, per_s): &(&'static str, f64)| {
        let (finer, coarser) = (usable(rate_hz * per_s), usable(rate_hz / per_s));
        finer.then_some(*name).or(coarser.then_some("seconds"))
    };
    UNITS.iter().find_map(unit).map_or(String::new(), |unit| format!(": is the time in {unit}?"))
}

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
    #[error("{what} has too few usable samples: {samples} of at least {FEWEST}")]
    Few {
        /// The signal.
        what: &'static str,
        /// The number of samples.
        samples: usize,
    },
    /// A rate outside of the range.
    #[error(
        "the sample rate is {} Hz, from the median time between two samples; it must be {} to {} Hz{}",
        plain(libm::rint(1e9 * .rate_hz) / 1e9), RATES_HZ.0, RATES_HZ.1, question(*.rate_hz)
    )]
    Rate {
        /// The rate \[Hz\].
        rate_hz: f64,
    },
    /// Too long.
    #[error(
        "the record is {} s long at {rate_hz:.0} Hz, with up to {} s from one sample to the next; at most 2,000,000 samples can be fitted",
        plain(*.duration_s), plain(*.longest_s)
    )]
    Long {
        /// Duration \[s\].
        duration_s: f64,
        /// Sample rate \[Hz\].
        rate_hz: f64,
        /// Longest time between two samples \[s\].
        longest_s: f64,
    },
    /// More gaps than data.
    #[error("{what}: {missing} of {samples} samples missing; at most half may be")]
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
