//! One ride: the bicycle, the assist, the rider and a disturbance at t = 0, until it falls or time is up.

mod assist;
mod batch;
mod conditions;
mod event;
mod human;
mod lanes;
mod logbook;
mod outcome;
mod outfit;
mod preroll;
mod processor;
mod refine;
mod sensor;
mod trace;

pub use assist::Assist;
pub use batch::{rides, rides_on, traced, traced_on};
pub use conditions::{Conditions, ConditionsError, Imu, ScheduleSpeed, Start};
pub use outcome::{Effort, FinalState, Outcome, Ride};
pub(crate) use outfit::frame as frame_of;
pub use processor::{Remote, RemoteError, Stepped};
pub use trace::{TracePoint, frames};
