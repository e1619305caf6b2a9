//! The nonlinear Whipple bicycle: parameters, geometry, state, velocities and accelerations.
//!
//! Four rigid bodies: rear frame with rigid rider, rear wheel, front frame, front wheel. Knife-edge wheels
//! roll without slip on level ground. Three independent speeds: roll rate, steer rate, rear wheel rate.
//! Derivation: `docs/bicycle.md`. Axes and signs of Meijaard et al. 2007: roll right +, steer right +, wheel
//! rates negative when rolling forward.

mod bias;
mod dynamics;
mod force;
mod geometry;
mod inertia;
mod motion;
mod parameters;
mod pitch;
mod pose;
mod redundant;
mod start;

pub use dynamics::{Accelerations, Torques};
pub use force::{ForcePoint, Forces};
pub use geometry::{Geometry, Gyrostat};
pub use motion::{Motion, Velocities};
pub use parameters::{KEYS, Parameters, RANGES, describe};
pub use pitch::{Attitude, front_contact_residual, pitch_from_upright};
pub use pose::Pose;
pub use redundant::FullState;
pub use start::Start;

use crate::num::{Lanes, Scalar};

/// The part of the bicycle's state on which its accelerations depend.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct State<S> {
    /// Roll angle \[rad\], right positive.
    pub roll: S,
    /// Steer angle \[rad\], right positive.
    pub steer: S,
    /// Roll rate, time derivative of the roll angle \[rad/s\].
    pub roll_rate: S,
    /// Steer rate \[rad/s\].
    pub steer_rate: S,
    /// Rear wheel's rate relative to the rear frame \[rad/s\], negative when rolling forward.
    pub rear_wheel_rate: S,
    /// Pitch \[rad\]: follows from roll and steer; stored as the initial guess of the next solution.
    pub pitch: S,
}

impl<S: Scalar> State<S> {
    /// Upright and straight at forward speed `v` \[m/s\], the rear wheel rolling.
    pub fn upright(b: &Geometry, v: S) -> Self {
        let zero = S::constant(0.0);
        Self {
            roll: zero,
            steer: zero,
            roll_rate: zero,
            steer_rate: zero,
            rear_wheel_rate: v * (-1.0 / b.rR),
            pitch: zero,
        }
    }
}

impl<const N: usize> State<Lanes<N>> {
    /// The state of one lane.
    pub(crate) fn lane(&self, lane: usize) -> State<f64> {
        State {
            roll: self.roll.0[lane],
            steer: self.steer.0[lane],
            roll_rate: self.roll_rate.0[lane],
            steer_rate: self.steer_rate.0[lane],
            rear_wheel_rate: self.rear_wheel_rate.0[lane],
            pitch: self.pitch.0[lane],
        }
    }

    /// Sets the state of one lane.
    pub(crate) fn set_lane(&mut self, lane: usize, to: &State<f64>) {
        self.roll.0[lane] = to.roll;
        self.steer.0[lane] = to.steer;
        self.roll_rate.0[lane] = to.roll_rate;
        self.steer_rate.0[lane] = to.steer_rate;
        self.rear_wheel_rate.0[lane] = to.rear_wheel_rate;
        self.pitch.0[lane] = to.pitch;
    }
}
