//! Human riders: delayed linear feedback of the bicycle's motion through the muscles of the
//! shoulders, in parallel with the assist (Kuipers 2020, sections 2.1.3 and 2.3; Schwab et al. 2013).

pub mod catalogue;
mod file;
mod fit;
mod gains;
mod muscles;
mod schedule;
mod table;

pub use fit::{Fit, Line};
pub use gains::{Gains, KEYS, Signals};
pub use muscles::{Muscles, MusclesError};
pub use schedule::{Outside, Schedule, ScheduleError};
pub use table::{RiderTable, Row};

/// A rider: what is fed back at which speed, how late, through which muscles.
#[derive(Clone, Debug, PartialEq)]
pub struct Rider {
    /// The gains over speed.
    pub schedule: Schedule,
    /// The one effective neural delay \[s\].
    pub delay_s: f64,
    /// The muscles.
    pub muscles: Muscles,
}

/// Longest neural delay \[s\].
pub const MAX_DELAY_S: f64 = 1.0;
