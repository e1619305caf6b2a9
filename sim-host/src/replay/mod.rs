//! Replay of a recorded ride through the firmware's control code: its torque, causes, and the margin of each check.
//!
//! Open loop: the computed torque did not act on the recorded bicycle.

mod checks;
mod column;
mod compare;
mod configure;
mod extract;
mod feed;
mod leap;
mod map;
mod map_error;
mod perturbed;
mod plausible;
mod row;
mod run;
mod samples;
mod summary;
mod unit;

pub use checks::Check;
pub use column::over_time;
pub use compare::Compared;
pub use configure::{Fitted, MapParameterError, fitted};
pub use extract::samples;
pub use feed::{Feed, FeedError, FeedOptions};
pub use leap::Leap;
pub use map::{Map, Mapped, Perturbation, References, Resample, SHIPPED, Signal, Source, Switch, Time};
pub use map_error::{ColumnsError, MapError, MapTextError, SignalError, UnitError};
pub use perturbed::{Perturbed, Timed, perturbed};
pub use row::Row;
pub use run::{CauseRecord, FramesError, ModeRecord, Press, Replayed, RunOptions, frames, run};
pub use samples::{Sample, Samples, Track};
pub use summary::{Alarms, Summary};
