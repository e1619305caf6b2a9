//! The classical Runge-Kutta method of fourth order with a fixed step.
//!
//! A sampled controller forces a step boundary each control period anyway; at 1 ms the method's
//! error is near rounding (`docs/performance.md`), so nothing adaptive is needed.

use crate::bicycle::{Geometry, Motion, State, Torques};
use crate::num::Scalar;

/// What acts on the bicycle during a step.
pub trait Actuation<S> {
    /// The torques at a motion met inside the step.
    fn torques(&self, b: &Geometry, motion: &Motion<S>) -> Torques<S>;
}

/// Torques that stay what they are during the step (zero-order hold).
impl<S: Scalar> Actuation<S> for Torques<S> {
    #[inline(always)]
    fn torques(&self, _: &Geometry, _: &Motion<S>) -> Torques<S> {
        *self
    }
}

/// The rate of change of every entry of [`State`], in the same places.
#[inline(always)]
pub fn rate<S: Scalar>(b: &Geometry, state: &State<S>, motion: &Motion<S>, torques: &Torques<S>) -> State<S> {
    let acc = motion.accelerations(b, torques);
    State {
        roll: state.roll_rate,
        steer: state.steer_rate,
        roll_rate: acc.roll,
        steer_rate: acc.steer,
        rear_wheel_rate: acc.rear_wheel,
        pitch: motion.actual.pitch,
    }
}

impl<S: Scalar> State<S> {
    /// `self + h * rate`, entry by entry.
    #[inline(always)]
    pub fn moved(&self, h: f64, rate: &State<S>) -> State<S> {
        State {
            roll: self.roll + rate.roll * h,
            steer: self.steer + rate.steer * h,
            roll_rate: self.roll_rate + rate.roll_rate * h,
            steer_rate: self.steer_rate + rate.steer_rate * h,
            rear_wheel_rate: self.rear_wheel_rate + rate.rear_wheel_rate * h,
            pitch: self.pitch + rate.pitch * h,
        }
    }
}

/// One step of `h` seconds from `state`, whose motion is `motion`.
#[inline(always)]
pub fn rk4<S: Scalar>(
    b: &Geometry,
    state: &State<S>,
    motion: &Motion<S>,
    h: f64,
    actuation: &impl Actuation<S>,
) -> State<S> {
    // The pitch just solved, not the one predicted to get there.
    let start = State { pitch: motion.pose.attitude.pitch, ..*state };
    let k1 = rate(b, &start, motion, &actuation.torques(b, motion));
    let k2 = stage(b, &start.moved(0.5 * h, &k1), actuation);
    let k3 = stage(b, &start.moved(0.5 * h, &k2), actuation);
    let k4 = stage(b, &start.moved(h, &k3), actuation);
    start.moved(h / 6.0, &k1).moved(h / 3.0, &k2).moved(h / 3.0, &k3).moved(h / 6.0, &k4)
}

#[inline(always)]
fn stage<S: Scalar>(b: &Geometry, state: &State<S>, actuation: &impl Actuation<S>) -> State<S> {
    let motion = Motion::new(b, state);
    rate(b, state, &motion, &actuation.torques(b, &motion))
}
