//! One control period: computes one torque command from one sensor frame.

use crate::command::Command;
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
use crate::sensors::measurements::{Measurements, SpeedInterval};
use crate::sensors::polarity::{self, PolarityState, PolarityStep};
use crate::sensors::sign_check::{self, SignCheckState};
use crate::sensors::validation::{self, ValidationState};

/// Controller state kept between steps. `State::default()` is the state at start-up.
///
/// The field order in memory matters, the long history last: the chip reaches the first 1 KiB in fewer instructions.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
#[repr(C)]
pub struct State {
    /// Time of the previous frame \[us\].
    previous_us: Option<u32>,
    validation: ValidationState,
    estimate: EstimateState,
    cross_check: CrossCheckState,
    sign_check: SignCheckState,
    polarity: PolarityState,
    polarity_torque_nm: f32,
    engagement: EngagementState,
    track: PathTrackingState,
    limiter: LimiterState,
    guard: GuardState,
    /// Limits that were active in the previous period.
    active_limits: ActiveLimits,
    /// Number of control periods in succession that were shorter than half of one, by their times.
    short_periods: u16,
    /// End of the last of them \[us\].
    short_period_us: u32,
    /// Causes for the next permission: of the guard in the previous period, and of a clock that stands.
    pending_causes: Causes,
    roll: Roll,
    smooth: SmoothState,
    history: History,
}

/// Estimated roll angle and its error, and the specific force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct Roll {
    /// Roll angle, right positive \[rad\].
    pub angle_rad: f32,
    /// Error of the roll angle.
    pub error: RollError,
    /// Magnitude of the specific force, if measured \[m/s^2\].
    pub force_m_s2: Option<f32>,
}

impl State {
    /// Last commanded torque, in the bicycle's sign \[N m\].
    pub fn torque_nm(&self) -> f32 {
        self.limiter.torque_nm()
    }

    /// Next step of the polarity check.
    pub fn polarity(&self) -> PolarityStep {
        self.polarity.next
    }

    /// Torque that the law would request during the polarity check, in the bicycle's sign \[N m\].
    pub fn polarity_torque_nm(&self) -> f32 {
        self.polarity_torque_nm
    }

    /// Slopes of gyro and motor from the sign check: 1 as expected, -1 reversed; `None` while the excitation is too
    /// small.
    pub fn slopes(&self) -> [Option<f32>; 2] {
        self.sign_check.slopes()
    }

    /// Permitted fraction of the torque, 0 to 1.
    pub fn authority(&self) -> f32 {
        self.engagement.authority()
    }

    /// Cross-check residuals of the last period.
    pub fn residuals(&self) -> Residuals {
        self.cross_check.residuals()
    }

    /// Slope of the measured yaw rate over the one expected from speed and steer angle: 1 as expected, -1 reversed;
    /// `None` while the excitation is too small.
    pub fn yaw_slope(&self) -> Option<f32> {
        self.cross_check.yaw_slope()
    }

    /// Correlation of the measured with the steering-induced roll acceleration, -1 to 1; `None` while the excitation is
    /// too small.
    pub fn roll_correlation(&self) -> Option<f32> {
        self.cross_check.roll_correlation()
    }

    /// State of the estimator.
    pub fn estimate(&self) -> &EstimateState {
        &self.estimate
    }

    /// State of the smoothing.
    pub fn smooth(&self) -> &SmoothState {
        &self.smooth
    }

    /// Estimated roll angle of the last period, with its error.
    pub fn roll(&self) -> Roll {
        self.roll
    }
}

/// One control period: computes the motor torque from the sensors' samples of this instant.
///
/// Without a valid roll rate or speed the law requests zero torque, reached at the rate limit. In the modes before
/// standby and on any violation found by the guard, the torque is zero at once; while the clock stands it starts at zero in
/// every period.
pub fn step(plan: &Plan, state: &mut State, frame: &SensorFrame) -> Command {
    let config = &plan.config;
    let elapsed_us = state.previous_us.map_or(plan.period_us, |previous| frame.now_us.wrapping_sub(previous));
    state.previous_us = Some(frame.now_us);
    if elapsed_us < plan.period_us / 2 {
        note_short_period(plan, state, frame.now_us, elapsed_us);
    }
    let last_torque_nm = state.torque_nm();

    let measurements = validation::step(
        &config.input,
        &plan.validation,
        &plan.calibration,
        &mut state.validation,
        frame,
        last_torque_nm,
    );
    let motion = motion(plan, &mut state.estimate, &measurements, elapsed_us);
    let Motion { roll_rad, roll_error, force_m_s2, .. } = motion;
    state.roll = Roll { angle_rad: roll_rad, error: roll_error, force_m_s2 };
    let predicted = predict::step(&config.predict, &motion);
    let cross_checked = cross_check::step(
        &config.cross,
        &plan.cross_check,
        &mut state.cross_check,
        &measurements,
        motion.roll_sin_cos,
        last_torque_nm,
    );
    if !cross_checked.invalidated.is_empty() {
        state.validation.invalidate(cross_checked.invalidated);
    }
    let sign_causes =
        sign_check::step(&plan.sign_check, &mut state.sign_check, &measurements, &motion, last_torque_nm);
    let mut causes =
        measurements.causes.with(cross_checked.causes).with(sign_causes).with(state.pending_causes);
    causes.note(Cause::Timing, elapsed_us > plan.max_gap_us);

    let speed = speed(plan, &measurements, &cross_checked);
    let aligned = match (measurements.gyro_rad_s(), speed) {
        (Some(_), Some(speed)) => {
            let age_ticks = frame.gyro_rad_s.age_ticks;
            let roll_rate_rad_s =
                smooth::step(&plan.smooth, &mut state.smooth, predicted.roll_rate_rad_s, age_ticks);
            let newest = Aligned { roll_rate_rad_s, speed };
            let aligned = state.history.align(&config.latency, newest);
            causes.note(Cause::Filling, aligned.is_none());
            aligned
        }
        _ => {
            state.history.clear();
            state.smooth = SmoothState::default();
            None
        }
    };

    if plan.polarity_check_due {
        let gain = plan.polarity_gain_nm_s_rad;
        polarity::step(&config.input, plan.period_s, &mut state.polarity, &measurements, gain);
        let roll_rate_rad_s = measurements.gyro_rad_s().map_or(0.0, |[x, ..]| x);
        state.polarity_torque_nm = gain * config.dead_band.excess(roll_rate_rad_s);
        causes.note(Cause::PolarityWrong, state.polarity.next == PolarityStep::Wrong);
    }
    let engagement_input = engagement::EngagementInput {
        causes,
        engage: frame.engage,
        polarity_checked: !plan.polarity_check_due || state.polarity.next == PolarityStep::Passed,
        roll_rad: (plan.needs_estimate && measurements.gyro_rad_s().is_some())
            .then_some((motion.roll_rad, motion.roll_error)),
        rates_rad_s: [motion.roll_rate_rad_s, motion.steer_rate_rad_s],
        speed_m_s: speed.map(|v| v.newest),
        force_m_s2: motion.force_m_s2,
    };
    let permission = engagement::step(
        &config.permit,
        &plan.engagement,
        &plan.reactions,
        &mut state.engagement,
        &engagement_input,
    );

    let (gain, law_nm, speed) = match aligned {
        Some(Aligned { roll_rate_rad_s, speed }) => {
            let gain = config.law.gain_towards_zero(speed.low, speed.high);
            let mut law_nm = gain * config.dead_band.excess(roll_rate_rad_s);
            if config.capsize.is_on() {
                law_nm += config.capsize.torque(speed.low, predicted.roll_rad);
            }
            (gain, law_nm, speed)
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
            acted: state.active_limits,
            authority: permission.authority,
            elapsed_us,
        };
        path_tracking::step(track, &mut state.track, &tracking)
    });
    let request = limiter::TorqueRequest {
        // Adding zero would turn -0 into 0.
        wanted_nm: if config.track.is_some() { law_nm + track_nm } else { law_nm },
        authority: permission.authority,
        limp: permission.mode == Mode::Limp,
        speed_low_m_s: speed.low,
        speed_high_m_s: speed.high,
        steer_rad: measurements.steer_rad(),
        steer_rate_rad_s: measurements.steer_rate_rad_s(),
        rider_torque_nm: measurements.rider_torque_nm(),
        elapsed_us,
    };
    let permitted = permission.mode >= Mode::Standby;
    let (limited_nm, limits) = if permitted {
        limiter::step(&config.limits, &plan.limiter, &mut state.limiter, &request)
    } else {
        state.limiter = LimiterState::default();
        (0.0, ActiveLimits::default())
    };
    let guard_result =
        guard::check(&config.limits, &plan.guard, &mut state.guard, limited_nm, permitted, &request);
    let torque_nm = guard_result.unwrap_or_else(|_| {
        state.limiter = LimiterState::default();
        0.0
    });
    state.active_limits = limits;
    state.pending_causes = guard_result.err().map_or(Causes::NONE, |violation| Causes::of(violation.cause()));
    Command {
        torque_nm: plan.calibration.motor(torque_nm),
        gain_nm_s_rad: if permission.authority > 0.0 { gain } else { 0.0 },
        limits,
        mode: permission.mode,
        causes: permission.causes.with(state.pending_causes),
    }
}

/// Counts a short period that ends now. After too many in succession the clock stands: no rate of change can be kept, and the torque
/// starts at zero in every period. It remains there, as no time passes in which a limited torque could rise.
#[cold]
#[inline(never)]
fn note_short_period(plan: &Plan, state: &mut State, now_us: u32, elapsed_us: u32) {
    let after_another = now_us.wrapping_sub(elapsed_us) == state.short_period_us;
    state.short_periods = if after_another { state.short_periods.saturating_add(1) } else { 1 };
    state.short_period_us = now_us;
    if state.short_periods > plan.most_short_periods {
        (state.limiter, state.guard) = (LimiterState::default(), GuardState::default());
        state.pending_causes.note(Cause::Timing, true);
    }
}

/// Estimates the motion from the valid measurements; copies the sensors' values if no function needs an estimate.
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
    if plan.needs_estimate {
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

/// Bounds of the scheduling wheel's speed: from its own sensor; from the other wheel's sensor and the steer angle while
/// its own sensor is lost; spanning both while the wheels disagree.
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
            // The front wheel's path is the longer one, at most about twice as long.
            let cos =
                cross_checked.ground.map_or(MIN_COS, |(_, cos)| if cos > MIN_COS { cos } else { MIN_COS });
            let ratio = if wheel == Wheel::Front { 1.0 / cos } else { cos };
            let other = other.spanning(other.scaled(ratio));
            Some(own.map_or(other, |own| own.spanning(other)))
        }
    }
}

/// Minimum assumed cosine of the ground steer angle; also used while that angle is unknown.
const MIN_COS: f32 = 0.4;
