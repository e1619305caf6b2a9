//! Fixed-step classical Runge-Kutta method of fourth order: one time step of the equations of motion, from
//! state and torques to the next state.
//!
//! A sampled controller needs a step boundary in each control period. At 1 ms the method's error is near
//! rounding (`docs/performance.md`), so the step size is not adaptive.

use crate::bicycle::{Accelerations, Geometry, Motion, State, Torques};
use crate::num::{Moves, Scalar};

/// Source of the torques that act on the bicycle during a time step.
pub trait Actuation<S: Scalar> {
    /// Begins a step at its start's motion: a sampled controller runs here.
    #[inline(always)]
    fn begin_step(&mut self, _: &Geometry, _: &Motion<S>) {}

    /// Torques for the motion at a Runge-Kutta stage; `stage` 0 is the start of the step, 3 its end.
    fn torques(&self, stage: usize, motion: &Motion<S>) -> Torques<S>;

    /// Accelerations for the motion at a stage; a source of other forces than torques replaces it.
    #[inline(always)]
    fn accelerations(&self, b: &Geometry, stage: usize, motion: &Motion<S>) -> Accelerations<S> {
        motion.accelerations(b, &self.torques(stage, motion))
    }

    /// Receives the accelerations that these torques caused. For actuations with their own state, integrated
    /// alongside by [`Stages`].
    #[inline(always)]
    fn end_stage(&mut self, _: &Geometry, _: usize, _: &State<S>, _: &Motion<S>, _: &Accelerations<S>) {}
}

/// Torques constant over the time step (zero-order hold).
impl<S: Scalar> Actuation<S> for Torques<S> {
    #[inline(always)]
    fn torques(&self, _: usize, _: &Motion<S>) -> Torques<S> {
        *self
    }
}

/// Time derivative of every entry of [`State`], stored in the same fields.
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

impl<S: Scalar> State<S> {
    /// The state after `h` seconds, in each lane its own time, at the given rates.
    #[inline(always)]
    pub(crate) fn after(&self, h: S, rate: &Self) -> Self {
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

impl<S: Scalar> Moves for State<S> {
    #[inline(always)]
    fn moved(&self, h: f64, rate: &Self) -> Self {
        self.after(S::constant(h), rate)
    }
}

/// Times of the stages, as fractions of the time step.
pub const STAGES: [f64; 4] = [0.0, 0.5, 0.5, 1.0];
/// Part of the time step from its start to the state of the next stage.
pub(crate) const AHEAD: [f64; 4] = [0.5, 0.5, 1.0, 0.0];
/// Weights of the stages' time derivatives.
pub(crate) const WEIGHT: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];

/// The four stages of a time step, of the bicycle or of any state integrated with it.
#[derive(Clone, Copy, Debug)]
pub struct Stages<X> {
    start: X,
    /// State at the current stage; without meaning after the last stage.
    pub at: X,
    /// State at the end of the step, complete after the last stage.
    pub end: X,
}

impl<X: Moves> Stages<X> {
    /// Before the first stage, from the state at the start of the step.
    #[inline(always)]
    pub fn new(start: X) -> Self {
        Self { start, at: start, end: start }
    }

    /// State at the start of the step.
    pub fn start(&self) -> X {
        self.start
    }

    /// Advances from `stage` to the next with the time derivative `k` at this stage; `h` is the time step
    /// \[s\].
    #[inline(always)]
    pub fn next(&mut self, stage: usize, h: f64, k: &X) {
        self.end = self.end.moved(h * WEIGHT[stage], k);
        self.at = self.start.moved(h * AHEAD[stage], k);
    }
}

/// One time step of `h` seconds.
///
/// Loops over the four stages, so that the binary contains the equations of motion once.
#[inline(always)]
pub fn rk4<S: Scalar>(b: &Geometry, state: &State<S>, h: f64, actuation: &mut impl Actuation<S>) -> State<S> {
    let mut stages = Stages::new(*state);
    for stage in 0..STAGES.len() {
        let motion = Motion::new(b, &stages.at);
        if stage == 0 {
            // The pitch solved from roll and steer, not the predicted one.
            let pitch = motion.pose.attitude.pitch;
            stages = Stages::new(State { pitch, ..*state });
            actuation.begin_step(b, &motion);
        }
        let acc = actuation.accelerations(b, stage, &motion);
        actuation.end_stage(b, stage, &stages.at, &motion, &acc);
        let k = rate(&stages.at, &motion, &acc);
        stages.next(stage, h, &k);
    }
    stages.end
}
