//! Steer assist of a ride: none, the flashed control crate, or its law in continuous time.

use crate::bicycle::{Geometry, Velocities};
use crate::num::Scalar;
use control::law::real::Real;
use control::{DeadBand, Law, Plan};
use std::fmt;
use std::sync::Arc;

/// The steer assist of a ride.
#[derive(Clone, Debug, PartialEq)]
pub enum Assist {
    /// No torque.
    None,
    /// The control crate: f32, sampled, torque held between samples, with all limits.
    Firmware(Box<Plan>),
    /// The law alone in f64, continuous in time, with exact sensors and no limits.
    Ideal(Box<IdealLaw>),
    /// A law of another program, under the same conditions as [`Assist::Ideal`].
    Own(OwnLaw),
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

    /// The same of several rides side by side, if the law is one formula at every speed and has no dead band.
    #[inline(always)]
    pub(super) fn formula<R: Real>(&self, roll_rate_rad_s: R, speed_m_s: R) -> Option<R> {
        if self.dead_band.is_on() { None } else { Some(self.law.formula(speed_m_s)? * roll_rate_rad_s) }
    }
}

/// Steer torque \[N m\] from roll rate \[rad/s\] and forward speed \[m/s\].
type TorqueNm = dyn Fn(f64, f64) -> f64 + Send + Sync;

/// A law of another program: a function of roll rate and forward speed. Two are equal if they are clones of one.
#[derive(Clone)]
pub struct OwnLaw(Arc<TorqueNm>);

impl OwnLaw {
    /// A law from a function of the roll rate \[rad/s\] and the forward speed \[m/s\] to the steer torque, positive to
    /// the right \[N m\]. It is called at every stage of the integration, from several threads. Basins are searched to
    /// one side: the function must be odd in the roll rate.
    pub fn new(torque_nm: impl Fn(f64, f64) -> f64 + Send + Sync + 'static) -> Self {
        Self(Arc::new(torque_nm))
    }

    /// Steer torque at a roll rate \[rad/s\] and a forward speed \[m/s\], positive to the right \[N m\].
    pub(super) fn torque_nm(&self, roll_rate_rad_s: f64, speed_m_s: f64) -> f64 {
        self.0(roll_rate_rad_s, speed_m_s)
    }
}

impl fmt::Debug for OwnLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("OwnLaw")
    }
}

impl PartialEq for OwnLaw {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
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
