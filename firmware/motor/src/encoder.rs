//! Motor angle and speed from encoder counts: a tracking loop that also validates each sample.
//!
//! The angle is the newest valid sample, extrapolated with the speed over its age. Only the speed is filtered, so
//! that a sudden motion does not misalign the field.

use crate::angle::Angle;
use crate::fault::{Fault, Faults};
use control::maths::bounded;
use control::param::{ParamSpec, ParamVisitor};
use control::sensors::frame::MISSING;
use core::f32::consts::TAU;

/// The encoder on the motor's shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EncoderConfig {
    /// Counts per turn.
    pub counts: u16,
    /// Whether the counts decrease when the motor turns forward.
    pub reversed: bool,
    /// Negative of the electrical angle at zero counts, as a fraction of a turn; found by alignment. `None`: unknown,
    /// no torque before alignment.
    pub offset_turns: Option<f32>,
    /// Timeout of a sample \[calls\].
    pub timeout_calls: u16,
    /// Largest difference of a sample from the extrapolated angle \[turns of the motor\]; well below an eighth of an
    /// electrical turn.
    pub jump_turns: f32,
    /// Largest speed \[turns/s of the motor\].
    pub speed_max_turns_s: f32,
    /// Bandwidth of the speed estimate \[Hz\].
    pub tracking_hz: f32,
}

impl EncoderConfig {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.count(&ParamSpec::new("encoder", "counts", 16.0, 65535.0), &mut self.counts);
        to.switch(&ParamSpec::switch("encoder", "reversed"), &mut self.reversed);
        to.optional_number(&ParamSpec::new("encoder", "offset_turns", -0.5, 0.5), &mut self.offset_turns);
        to.count(&ParamSpec::new("encoder", "timeout_calls", 1.0, 1000.0), &mut self.timeout_calls);
        to.number(&ParamSpec::new("encoder", "jump_turns", 1e-4, 0.125), &mut self.jump_turns);
        to.number(&ParamSpec::new("encoder", "speed_max_turns_s", 1.0, 1000.0), &mut self.speed_max_turns_s);
        to.number(&ParamSpec::new("encoder", "tracking_hz", 5.0, 1000.0), &mut self.tracking_hz);
    }
}

/// Constants that follow from the encoder and the call rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EncoderPlan {
    config: EncoderConfig,
    /// Units of [`Angle`] per count.
    count: u32,
    period_s: f32,
    /// Correction of angle and speed per turn of error and call; both poles lie at the bandwidth.
    angle_gain: f32,
    speed_gain_s: f32,
}

impl EncoderPlan {
    /// Constants for `rate_hz` calls per second.
    pub fn new(config: &EncoderConfig, rate_hz: f32) -> Self {
        let pole = TAU * config.tracking_hz;
        Self {
            config: *config,
            count: ((1_u64 << 32) / u64::from(config.counts.max(1))) as u32,
            period_s: 1.0 / rate_hz,
            angle_gain: 2.0 * pole / rate_hz,
            speed_gain_s: pole * pole / rate_hz,
        }
    }
}

/// State of the encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EncoderState {
    /// Last valid sample, positive forward.
    sample: Angle,
    /// Its age \[calls\].
    age: u16,
    /// Reported age of the last sample.
    reported_age: u16,
    /// Tracked angle and speed.
    followed: Angle,
    speed_turns_s: f32,
    /// Whether a second sample has given a speed.
    moving: bool,
    /// Reason for which the newest sample was rejected.
    rejected: Fault,
}

impl Default for EncoderState {
    fn default() -> Self {
        Self {
            sample: Angle(0),
            age: MISSING,
            reported_age: MISSING,
            followed: Angle(0),
            speed_turns_s: 0.0,
            moving: false,
            rejected: Fault::EncoderLost,
        }
    }
}

/// Angle, speed and faults from the encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EncoderReading {
    /// Present motor angle, positive forward.
    pub angle: Angle,
    /// Motor speed \[turns/s\].
    pub speed_turns_s: f32,
    /// Faults of the encoder.
    pub faults: Faults,
}

/// One call, with the newest sample's counts and its age in calls ([`MISSING`]: none yet).
pub fn step(plan: &EncoderPlan, state: &mut EncoderState, counts: u16, age_calls: u16) -> EncoderReading {
    let config = &plan.config;
    state.age = state.age.saturating_add(1);
    state.followed = state.followed.plus(Angle::of(state.speed_turns_s * plan.period_s));
    let new = age_calls != state.reported_age.saturating_add(1) && age_calls <= config.timeout_calls;
    state.reported_age = age_calls;
    // A loss is reported even if it ends in this call.
    let mut faults = Faults::NONE;
    faults.note(state.rejected, state.age > config.timeout_calls);
    if new {
        take(plan, state, counts, age_calls);
    }
    let speed = state.speed_turns_s;
    faults.note(Fault::EncoderSpeed, speed.abs() > config.speed_max_turns_s);
    let since = f32::from(state.age.min(config.timeout_calls)) * plan.period_s;
    EncoderReading { angle: state.sample.plus(Angle::of(speed * since)), speed_turns_s: speed, faults }
}

/// Processes a new sample.
fn take(plan: &EncoderPlan, state: &mut EncoderState, counts: u16, age: u16) {
    let config = &plan.config;
    if counts >= config.counts {
        state.rejected = Fault::EncoderRange;
        return;
    }
    let forward = Angle(u32::from(counts).wrapping_mul(plan.count));
    let sample = if config.reversed { forward.mirrored() } else { forward };
    let calls = f32::from(state.age.saturating_sub(age).clamp(1, 20));
    let most = 1.25 * config.speed_max_turns_s;
    if state.age > config.timeout_calls {
        // First sample at all or after a loss: the loop restarts, and the second sample gives the speed.
        (state.followed, state.speed_turns_s, state.moving) = (sample, 0.0, false);
    } else if !state.moving {
        let speed = sample.minus(state.sample).signed() / (calls * plan.period_s);
        (state.speed_turns_s, state.moving) = (bounded(speed, most), true);
        state.followed = sample.plus(Angle::of(state.speed_turns_s * f32::from(age) * plan.period_s));
    }
    let now = sample.plus(Angle::of(state.speed_turns_s * f32::from(age) * plan.period_s));
    let error = now.minus(state.followed).signed();
    if error.abs() > config.jump_turns {
        state.rejected = Fault::EncoderJump;
        return;
    }
    // A sample every n calls is weighted n-fold.
    state.followed = state.followed.plus(Angle::of(bounded(plan.angle_gain * calls, 1.0) * error));
    state.speed_turns_s = bounded(state.speed_turns_s + plan.speed_gain_s * calls * error, most);
    (state.sample, state.age, state.rejected) = (sample, age, Fault::EncoderLost);
}
