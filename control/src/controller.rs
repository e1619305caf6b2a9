//! The composition: one sensor frame in, one torque command out.

use crate::estimate::predict;
use crate::estimate::smooth::{self, SmoothState};
use crate::estimate::{self, EstimateState, EstimatorInput, Motion, RollError};
use crate::fault::{Cause, Causes};
use crate::law::path_tracking::{self, PathError, PathTrackingState};
use crate::plan::Plan;
use crate::safety::engagement::{self, EngagementState, Mode};
use crate::safety::guard::{self, GuardState};
use crate::safety::limiter::{self, LimiterState};
use crate::safety::limits::ActiveLimits;
use crate::sensors::cross_check::{self, CrossCheckResult, CrossCheckState, Residuals};
use crate::sensors::frame::{SensorFrame, Wheel};
use crate::sensors::latency::{Aligned, History};
use crate::sensors::polarity::{self, PolarityState, PolarityStep};
use crate::sensors::sign_check::{self, SignCheckState};
use crate::sensors::validation::{self, Measurements, SpeedInterval, ValidationState};

/// What the controller remembers between steps. `State::default()` is a controller just started.
///
/// In this order in memory, the long history last: the chip reaches the first 1 KiB in fewer instructions.
#[derive(Clone, Debug, Default)]
#[repr(C)]
pub struct State {
    /// The time of the frame before \[us\].
    before_us: Option<u32>,
    input: ValidationState,
    estimate: EstimateState,
    cross: CrossCheckState,
    response: SignCheckState,
    polarity: PolarityState,
    hand_torque_nm: f32,
    permit: EngagementState,
    track: PathTrackingState,
    shape: LimiterState,
    guard: GuardState,
    /// The limits that acted in the period before.
    acted: ActiveLimits,
    /// What the guard found in the period before.
    found: Causes,
    roll: Roll,
    smooth: SmoothState,
    history: History,
}

/// What the estimator says of the roll angle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Roll {
    /// The angle, right positive \[rad\].
    pub angle_rad: f32,
    /// By how much it may be wrong.
    pub error: RollError,
    /// Size of the specific force, if it is known \[m/s^2\].
    pub force_m_s2: Option<f32>,
}

impl State {
    /// The torque commanded last, in the bicycle's sign \[N m\].
    pub fn torque_nm(&self) -> f32 {
        self.shape.torque_nm()
    }

    /// What is to be done next in the polarity check.
    pub fn polarity(&self) -> PolarityStep {
        self.polarity.next
    }

    /// The torque the law would ask for during the polarity check, in the bicycle's sign \[N m\].
    pub fn hand_torque_nm(&self) -> f32 {
        self.hand_torque_nm
    }

    /// How much of what they should do gyro and motor do: 1 all, -1 the opposite; `None` while too little happens.
    pub fn slopes(&self) -> [Option<f32>; 2] {
        self.response.slopes()
    }

    /// The part of the torque that is permitted, 0 to 1.
    pub fn authority(&self) -> f32 {
        self.permit.authority()
    }

    /// By how much the sensors of the last period differ from what the others say.
    pub fn residuals(&self) -> Residuals {
        self.cross.residuals()
    }

    /// How much of what it should do by speed and steer angle the yaw rate does: 1 all, -1 the opposite; `None` while too
    /// little happens.
    pub fn yaw_slope(&self) -> Option<f32> {
        self.cross.yaw_slope()
    }

    /// How well the roll follows from steering: 1 if exactly, -1 if in everything the other way; `None` while too little
    /// happens.
    pub fn roll_correlation(&self) -> Option<f32> {
        self.cross.roll_correlation()
    }

    /// The roll angle of the last period as estimated, and how sure that is.
    pub fn roll(&self) -> Roll {
        self.roll
    }
}

/// What the motor is asked for, and how that came about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// Steer torque, positive to the right as the motor counts \[N m\]. Always finite.
    pub torque_nm: f32,
    /// The gain used \[N m s/rad\]; 0 while there is nothing to use it on.
    pub gain_nm_s_rad: f32,
    /// The limits that changed the torque.
    pub limits: ActiveLimits,
    /// Where the controller stands.
    pub mode: Mode,
    /// Everything that stands in the way of the torque, or is worth knowing.
    pub causes: Causes,
}

/// One control period: the torque for the motor from the sensors of this instant.
///
/// Without a believable roll rate or speed zero torque is wanted, reached as fast as the limits let
/// it. In the modes before standby, and on any finding of the guard, it is zero at once.
pub fn step(plan: &Plan, state: &mut State, frame: &SensorFrame) -> Command {
    let config = &plan.config;
    let elapsed_us = state.before_us.map_or(plan.period_us, |before| frame.now_us.wrapping_sub(before));
    state.before_us = Some(frame.now_us);
    let last_nm = state.torque_nm();

    let measurements =
        validation::step(&config.input, &plan.input, &plan.calibration, &mut state.input, frame, last_nm);
    let motion = motion(plan, &mut state.estimate, &measurements, elapsed_us);
    let Motion { roll_rad, roll_error, force_m_s2, .. } = motion;
    state.roll = Roll { angle_rad: roll_rad, error: roll_error, force_m_s2 };
    let ahead = predict::step(&config.predict, &motion);
    let cross_checked = cross_check::step(
        &config.cross,
        &plan.cross,
        &mut state.cross,
        &measurements,
        motion.roll_sin_cos,
        last_nm,
    );
    if !cross_checked.invalidated.is_empty() {
        state.input.invalidate(cross_checked.invalidated);
    }
    let sign_causes = sign_check::step(&plan.response, &mut state.response, &measurements, &motion, last_nm);
    let mut causes = measurements.causes.with(cross_checked.causes).with(sign_causes).with(state.found);
    causes.note(Cause::Timing, elapsed_us as f32 > plan.max_gap_us);

    let speed = speed(plan, &measurements, &cross_checked);
    let now = match (measurements.gyro_rad_s(), speed) {
        (Some(_), Some(speed)) => {
            let age_ticks = frame.gyro_rad_s.age_ticks;
            let roll_rate_rad_s =
                smooth::step(&plan.smooth, &mut state.smooth, ahead.roll_rate_rad_s, age_ticks);
            let newest = Aligned { roll_rate_rad_s, speed };
            let now = state.history.align(&config.latency, newest);
            causes.note(Cause::Filling, now.is_none());
            now
        }
        _ => {
            state.history.clear();
            state.smooth = SmoothState::default();
            None
        }
    };

    if plan.check_polarity {
        let gain = plan.shown_gain_nm_s_rad;
        state.hand_torque_nm =
            polarity::step(&config.input, plan.period_s, &mut state.polarity, &measurements, gain);
        causes.note(Cause::PolarityWrong, state.polarity.next == PolarityStep::Wrong);
    }
    let request = engagement::EngagementInput {
        causes,
        engage: frame.engage,
        polarity_checked: !plan.check_polarity || state.polarity.next == PolarityStep::Passed,
        roll_rad: (plan.estimates && measurements.gyro_rad_s().is_some())
            .then_some((motion.roll_rad, motion.roll_error)),
        rates_rad_s: [motion.roll_rate_rad_s, motion.steer_rate_rad_s],
        speed_m_s: speed.map(|v| v.newest),
        force_m_s2: motion.force_m_s2,
    };
    let permission =
        engagement::step(&config.permit, &plan.permit, &plan.reactions, &mut state.permit, &request);

    let (gain, law_nm, bounds) = match now {
        Some(Aligned { roll_rate_rad_s, speed }) => {
            let gain = config.law.gain_towards_zero(speed.low, speed.high);
            let mut wanted = gain * roll_rate_rad_s;
            if config.capsize.is_on() {
                wanted += config.capsize.torque(speed.low, ahead.roll_rad);
            }
            (gain, wanted, speed)
        }
        None => (0.0, 0.0, SpeedInterval::default()),
    };
    let track_nm = config.track.as_ref().map_or(0.0, |track| {
        let tracking = path_tracking::TrackingInput {
            roll_rad: motion.roll_rad,
            steer_rad: motion.steer_rad,
            roll_rate_rad_s: motion.roll_rate_rad_s,
            steer_rate_rad_s: motion.steer_rate_rad_s,
            speed_m_s: motion.speed_m_s,
            path: measurements.path().map(|[heading_rad, lateral_m]| PathError { heading_rad, lateral_m }),
            rider_torque_nm: measurements.rider_torque_nm(),
            acted: state.acted,
            authority: permission.authority,
            elapsed_us,
        };
        path_tracking::step(track, &mut state.track, &tracking)
    });
    let request = limiter::TorqueRequest {
        // Zero added would turn -0 into 0.
        wanted_nm: if config.track.is_some() { law_nm + track_nm } else { law_nm },
        authority: permission.authority,
        limp: permission.mode == Mode::Limp,
        speed_low_m_s: bounds.low,
        speed_high_m_s: bounds.high,
        steer_rad: measurements.steer_rad(),
        steer_rate_rad_s: measurements.steer_rate_rad_s(),
        rider_torque_nm: measurements.rider_torque_nm(),
        elapsed_us,
    };
    let permitted = permission.mode >= Mode::Standby;
    let (limited_nm, limits) = if permitted {
        limiter::step(&config.limits, &plan.shape, &mut state.shape, &request)
    } else {
        state.shape = LimiterState::default();
        (0.0, ActiveLimits::default())
    };
    let checked =
        guard::check(&config.limits, &plan.guard, &mut state.guard, limited_nm, permitted, &request);
    let torque_nm = checked.unwrap_or_else(|_| {
        state.shape = LimiterState::default();
        0.0
    });
    state.acted = limits;
    state.found = checked.err().map_or(Causes::NONE, |violation| Causes::of(violation.cause()));
    Command {
        torque_nm: plan.calibration.motor(torque_nm),
        gain_nm_s_rad: if permission.authority > 0.0 { gain } else { 0.0 },
        limits,
        mode: permission.mode,
        causes: permission.causes.with(state.found),
    }
}

/// The motion from what is believed; if nothing needs more, just what the sensors say.
fn motion(plan: &Plan, state: &mut EstimateState, measurements: &Measurements, elapsed_us: u32) -> Motion {
    let rear = measurements.rear_wheel_m_s().or(measurements.front_wheel_m_s());
    let input = EstimatorInput {
        gyro_rad_s: measurements.gyro_or_zero_rad_s(),
        accel_m_s2: measurements.accel_m_s2(),
        steer_rad: measurements.steer_rad(),
        steer_rate_rad_s: measurements.steer_rate_rad_s(),
        speed_m_s: rear.map_or(0.0, |v| v.newest),
        elapsed_us,
    };
    if plan.estimates {
        return estimate::step(&plan.config.estimate, state, &input);
    }
    let [roll_rate_rad_s, ..] = input.gyro_rad_s;
    Motion {
        roll_rate_rad_s,
        steer_rad: input.steer_rad.unwrap_or(0.0),
        steer_rate_rad_s: input.steer_rate_rad_s.unwrap_or(0.0),
        speed_m_s: input.speed_m_s,
        roll_sin_cos: (0.0, 1.0),
        roll_error: RollError::UNKNOWN,
        force_m_s2: input.accel_m_s2.map(estimate::size),
        ..Motion::default()
    }
}

/// Between which speeds of the scheduling wheel the truth lies: by that wheel's sensor; by the other's
/// and the steer angle while it is lost; by both when they disagree.
fn speed(
    plan: &Plan,
    measurements: &Measurements,
    cross_checked: &CrossCheckResult,
) -> Option<SpeedInterval> {
    let disagree = cross_checked.causes.has(Cause::WheelsDisagree);
    let (front, rear) = (measurements.front_wheel_m_s(), measurements.rear_wheel_m_s());
    let wheel = plan.config.input.wheel;
    let (own, other) = match wheel {
        Wheel::Front => (front, rear),
        Wheel::Rear => (rear, front),
    };
    match (own, other) {
        (Some(_), None) => own,
        (Some(_), Some(_)) if !disagree => own,
        (_, None) => None,
        (_, Some(other)) => {
            // The front wheel goes the longer way, at most about twice as long.
            let cos = cross_checked
                .ground
                .map_or(LEAST_COS, |(_, cos)| if cos > LEAST_COS { cos } else { LEAST_COS });
            let ratio = if wheel == Wheel::Front { 1.0 / cos } else { cos };
            let other = other.spanning(other.scaled(ratio));
            Some(own.map_or(other, |own| own.spanning(other)))
        }
    }
}

/// Cosine of the largest steer angle on the ground that is reckoned with while it is not known.
const LEAST_COS: f32 = 0.4;
