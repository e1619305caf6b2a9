//! Steer assist of a ride: none, the flashed control crate, or its law in continuous time.

use crate::bicycle::{Geometry, Velocities};
use crate::num::Scalar;
use control::{DeadBand, Law, Plan};

/// The steer assist of a ride.
#[derive(Clone, Debug, PartialEq)]
pub enum Assist {
    /// No torque.
    None,
    /// The control crate: f32, sampled, torque held between samples, with all limits.
    Firmware(Box<Plan>),
    /// The law alone in f64, continuous in time, with exact sensors and no limits.
    Ideal(Box<IdealLaw>),
}

/// A roll-rate law behind its dead band, in f64.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct IdealLaw {
    /// The law.
    pub law: Law,
    /// Its dead band.
    pub dead_band: DeadBand,
}

impl IdealLaw {
    /// Steer torque at a roll rate \[rad/s\] and a forward speed \[m/s\], positive to the right \[N m\].
    #[inline(always)]
    pub(super) fn torque_nm(&self, roll_rate_rad_s: f64, speed_m_s: f64) -> f64 {
        self.law.gain(speed_m_s) * self.dead_band.excess(roll_rate_rad_s)
    }
}

impl From<Law> for IdealLaw {
    /// The law without a dead band.
    fn from(law: Law) -> Self {
        Self { law, ..Self::default() }
    }
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
