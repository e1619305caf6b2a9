//! The classical Runge-Kutta method of fourth order with a fixed step.
//!
//! A sampled controller forces a step boundary each control period anyway; at 1 ms the method's
//! error is near rounding (`docs/performance.md`), so nothing adaptive is needed.

use crate::bicycle::{Geometry, Motion, State, Torques};
use crate::num::Scalar;

/// What acts on the bicycle during a step.
pub trait Actuation<S> {
    /// The torques at a motion met inside the step; `stage` 0 is the step's start, 3 its end.
    fn torques(&mut self, b: &Geometry, stage: usize, motion: &Motion<S>) -> Torques<S>;
}

/// Torques that stay what they are during the step (zero-order hold).
impl<S: Scalar> Actuation<S> for Torques<S> {
    #[inline(always)]
    fn torques(&mut self, _: &Geometry, _: usize, _: &Motion<S>) -> Torques<S> {
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

/// One step of `h` seconds.
///
/// One loop over the four stages, so that the equations of motion stand in the binary once.
#[inline(always)]
pub fn rk4<S: Scalar>(b: &Geometry, state: &State<S>, h: f64, actuation: &mut impl Actuation<S>) -> State<S> {
    const AHEAD: [f64; 4] = [0.5, 0.5, 1.0, 0.0];
    const WEIGHT: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];
    let (mut start, mut at, mut end) = (*state, *state, *state);
    for stage in 0..4 {
        let motion = Motion::new(b, &at);
        if stage == 0 {
            // The pitch just solved, not the one predicted to get here.
            start.pitch = motion.pose.attitude.pitch;
            end = start;
        }
        let torques = actuation.torques(b, stage, &motion);
        let k = rate(b, &at, &motion, &torques);
        end = end.moved(h * WEIGHT[stage], &k);
        at = start.moved(h * AHEAD[stage], &k);
    }
    end
}
