//! The classical Runge-Kutta method of fourth order with a fixed step.
//!
//! A sampled controller forces a step boundary each control period anyway; at 1 ms the method's
//! error is near rounding (`docs/performance.md`), so nothing adaptive is needed.

use crate::bicycle::{Accelerations, Geometry, Motion, State, Torques};
use crate::num::Scalar;

/// What acts on the bicycle during a step.
pub trait Actuation<S> {
    /// The torques at a motion met inside the step; `stage` 0 is the step's start, 3 its end.
    fn torques(&mut self, b: &Geometry, stage: usize, motion: &Motion<S>) -> Torques<S>;

    /// Tells the accelerations that these torques led to, for what acts with a state of its own and
    /// takes part in the step by [`Stages`].
    #[inline(always)]
    fn end_stage(&mut self, _: &Geometry, _: usize, _: &State<S>, _: &Motion<S>, _: &Accelerations<S>) {}
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
pub fn rate<S: Scalar>(state: &State<S>, motion: &Motion<S>, acc: &Accelerations<S>) -> State<S> {
    State {
        roll: state.roll_rate,
        steer: state.steer_rate,
        roll_rate: acc.roll,
        steer_rate: acc.steer,
        rear_wheel_rate: acc.rear_wheel,
        pitch: motion.actual.pitch,
    }
}

/// Something with a rate of change.
pub trait Moves: Copy {
    /// `self + h * rate`, entry by entry.
    fn moved(&self, h: f64, rate: &Self) -> Self;
}

impl<S: Scalar> Moves for State<S> {
    #[inline(always)]
    fn moved(&self, h: f64, rate: &Self) -> Self {
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

/// When the stages of a step are, as parts of it.
pub const STAGES: [f64; 4] = [0.0, 0.5, 0.5, 1.0];

/// The four stages of a step, of the bicycle or of anything that moves with it.
#[derive(Clone, Copy, Debug)]
pub struct Stages<X> {
    start: X,
    /// The argument of the present stage; after the last stage of no use.
    pub at: X,
    /// After the last stage, the step's end.
    pub end: X,
}

impl<X: Moves> Stages<X> {
    /// Before the first stage.
    #[inline(always)]
    pub fn new(start: X) -> Self {
        Self { start, at: start, end: start }
    }

    /// What the step starts from.
    pub fn start(&self) -> X {
        self.start
    }

    /// From `stage` to the next one by the rate of change `k` at this one; `h` is the step's length \[s\].
    #[inline(always)]
    pub fn next(&mut self, stage: usize, h: f64, k: &X) {
        const AHEAD: [f64; 4] = [0.5, 0.5, 1.0, 0.0];
        const WEIGHT: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];
        self.end = self.end.moved(h * WEIGHT[stage], k);
        self.at = self.start.moved(h * AHEAD[stage], k);
    }
}

/// One step of `h` seconds.
///
/// One loop over the four stages, so that the equations of motion stand in the binary once.
#[inline(always)]
pub fn rk4<S: Scalar>(b: &Geometry, state: &State<S>, h: f64, actuation: &mut impl Actuation<S>) -> State<S> {
    let mut stages = Stages::new(*state);
    for stage in 0..STAGES.len() {
        let motion = Motion::new(b, &stages.at);
        if stage == 0 {
            // The pitch just solved, not the one predicted to get here.
            let pitch = motion.pose.attitude.pitch;
            stages = Stages::new(State { pitch, ..*state });
        }
        let torques = actuation.torques(b, stage, &motion);
        let acc = motion.accelerations(b, &torques);
        actuation.end_stage(b, stage, &stages.at, &motion, &acc);
        let k = rate(&stages.at, &motion, &acc);
        stages.next(stage, h, &k);
    }
    stages.end
}
