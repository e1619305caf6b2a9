//! Rider models: delayed linear feedback of the bicycle's motion through neuromuscular dynamics of the
//! shoulders, in parallel with the assist (Kuipers 2020, sections 2.1.3 and 2.3; Schwab et al. 2013).

mod delay_line;
mod error;
mod gains;
mod neuromuscular;
mod schedule;
mod signal_history;
mod state;
mod stepped;

pub use delay_line::DelayLine;
pub use error::{ScheduleError, UnfitError};
pub use gains::{Gains, KEYS, Signals};
pub use neuromuscular::Neuromuscular;
pub use schedule::{Outside, Schedule};
pub use signal_history::SignalHistory;
pub use state::{Instant, RiderState};
pub use stepped::{RiderSample, SteppedRider};

use crate::range::within;

/// A rider model: gain schedule, neural delay and neuromuscular dynamics.
#[derive(Clone, Debug, PartialEq)]
pub struct Rider {
    /// Gains as functions of speed.
    pub schedule: Schedule,
    /// Effective neural delay \[s\].
    pub delay_s: f64,
    /// Neuromuscular dynamics.
    pub neuromuscular: Neuromuscular,
}

/// Longest neural delay \[s\].
pub const MAX_DELAY_S: f64 = 1.0;

impl Rider {
    /// The delay in steps of `step_s` seconds, rounded to the nearest whole number.
    pub fn delay_steps(&self, step_s: f64) -> usize {
        (self.delay_s / step_s).round() as usize
    }

    /// Checks ranges, and that the delay is a whole number of steps of `step_s` seconds.
    ///
    /// # Errors
    /// States the value and its range, or the nearest possible delays.
    pub fn check(&self, step_s: f64) -> Result<(), UnfitError> {
        within("neural delay (s)", self.delay_s, 0.0, MAX_DELAY_S)?;
        self.neuromuscular.check()?;
        let steps = self.delay_s / step_s;
        if (steps - self.delay_steps(step_s) as f64).abs() <= 1e-6 {
            return Ok(());
        }
        Err(UnfitError::Steps { delay_s: self.delay_s, step_s })
    }
}
