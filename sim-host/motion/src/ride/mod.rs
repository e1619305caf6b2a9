//! Simulation of one ride: bicycle, assist, rider and a disturbance at t = 0, until a fall or the time limit.

mod assist;
mod backend;
mod batch;
mod conditions;
mod event;
mod fall;
mod hardware;
mod instructions;
mod lanes;
mod outcome;
mod perturbed;
mod quick;
mod recorder;
mod rider_lanes;
mod sensor;
mod steer_torque;
mod stepped;
mod substeps;
mod trace;
mod warm_start;

pub use crate::bicycle::Start;
pub use crate::plant::Imu;
pub use assist::{Assist, IdealLaw, OwnLaw};
pub use backend::{Remote, RemoteError, Stepped};
pub use batch::{accelerations, rides, rides_on, side_by_side, traced, traced_on, traced_until};
pub use conditions::{Conditions, ConditionsError, ScheduleSpeed};
pub use fall::{FallCause, FallCriterion, LaidFlat};
pub use hardware::frame as frame_of;
pub use outcome::{Effort, FinalState, Outcome, Ride};
pub use perturbed::{MotionSample, Perturbed, PerturbedRide, Push, perturbed};
pub use quick::{Foreseen, Quick, QuickRide};
pub use sensor::clock_us;
pub use stepped::{Applied, BicycleSample, SteppedBicycle};
pub use trace::{TracePoint, frames};
pub use warm_start::{Engaged, engaged};
