//! Steer assist of a ride: none, the flashed control crate, or its law in continuous time.

use crate::bicycle::{Geometry, Velocities};
use crate::num::Scalar;
use control::{Law, Plan};

/// The steer assist of a ride.
#[derive(Clone, Debug, PartialEq)]
pub enum Assist {
    /// No torque.
    None,
    /// The control crate: f32, sampled, torque held between samples, with all limits.
    Firmware(Box<Plan>),
    /// The law alone in f64, continuous in time, with exact sensors and no limits.
    Ideal(Box<Law>),
}

/// Forward speed at the front wheel \[m/s\].
#[inline(always)]
pub(super) fn front_speed<S: Scalar>(b: &Geometry, v: &Velocities<S>) -> S {
    v.front_spin * -b.rF
}

/// Forward speed at the rear wheel \[m/s\].
#[inline(always)]
pub(super) fn rear_speed<S: Scalar>(b: &Geometry, v: &Velocities<S>) -> S {
    v.rear_spin * -b.rR
}

/// Angular velocity of the rear frame about its x axis, horizontal when upright \[rad/s\].
#[inline(always)]
pub(super) fn body_roll_rate<S: Scalar>(b: &Geometry, v: &Velocities<S>) -> S {
    v.omega.x * libm::cos(b.lam) + v.omega.z * libm::sin(b.lam)
}
