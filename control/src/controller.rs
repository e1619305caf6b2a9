//! The composition: one sensor frame in, one torque command out.

use crate::calibrate::CalibrationPlan;
use crate::config::Config;
use crate::cross::{self, CrossPlan, CrossState, Crossed, Residuals};
use crate::estimate::{self, EstimateState, Felt, Motion, RollError};
use crate::fault::{Cause, Causes};
use crate::frame::{SensorFrame, Wheel};
use crate::guard::{self, GuardPlan, GuardState};
use crate::history::{Aligned, History};
use crate::input::{self, Believed, Bounds, InputPlan, InputState};
use crate::limits::ActiveLimits;
use crate::permit::{self, Mode, PermitPlan, PermitState, Reactions};
use crate::polarity::{self, Move, PolarityState};
use crate::predict;
use crate::response::{self, ResponsePlan, ResponseState};
use crate::shape::{self, ShapePlan, ShapeState};
use crate::smooth::{self, SmoothPlan, SmoothState};
use crate::track::{self, PathError, TrackState};

/// A checked [`Config`] with what is derived from it. Read-only while the controller runs.
///
/// In this order in memory, for the reason given at [`State`]; the long configuration last.
#[derive(Clone, Debug, PartialEq)]
#[repr(C)]
pub struct Plan {
    period_s: f32,
    period_us: u32,
    /// Longest time between two steps \[us\]; infinite without a limit.
    max_gap_us: f32,
    calibration: CalibrationPlan,
    input: InputPlan,
    cross: CrossPlan,
    response: ResponsePlan,
    permit: PermitPlan,
    smooth: SmoothPlan,
    reactions: Reactions,
    shape: ShapePlan,
    guard: GuardPlan,
    /// The polarity check is still to be passed.
    check_polarity: bool,
    /// The law's gain that the polarity check shows.
    shown_gain_nm_s_rad: f32,
    /// Whether anything needs more of the motion than the gyro's x axis.
    estimates: bool,
    config: Config,
}

impl Plan {
    /// Of a configuration that was checked.
    pub(crate) fn new(config: Config) -> Self {
        let c = &config;
        let crosses = c.cross.wheels_m_s.is_some()
            || c.cross.yaw_rad_s.is_some()
            || c.cross.yaw_slow_rad_s.is_some()
            || c.cross.yaw_slope
            || c.cross.roll_correlation;
        Self {
            period_s: 1.0 / c.rate_hz,
            period_us: (1e6 / c.rate_hz) as u32,
            max_gap_us: c.input.max_gap_ms.map_or(f32::INFINITY, |ms| 1e3 * ms),
            calibration: c.calibration.plan(),
            input: InputPlan::new(&c.input, 1.0 / c.rate_hz),
            cross: CrossPlan::new(&c.cross, &c.estimate.balance, c.rate_hz),
            response: ResponsePlan::new(&c.response, &c.estimate, c.rate_hz),
            permit: PermitPlan::new(&c.permit, c.rate_hz),
            smooth: SmoothPlan::new(&c.smooth, 1.0 / c.rate_hz),
            reactions: Reactions::new(&c.input),
            shape: ShapePlan::new(&c.limits, c.rate_hz),
            guard: GuardPlan::new(&c.limits, c.rate_hz),
            check_polarity: c.permit.need_polarity && !c.calibration.polarity_checked,
            shown_gain_nm_s_rad: c.law.gain(polarity::SHOWN_AT_M_S),
            estimates: c.estimate.roll_rate == estimate::Source::Estimate
                || c.capsize.is_on()
                || c.permit.fallen_rad.is_some()
                || c.predict.lead_s > 0.0
                || c.track.is_some()
                || c.response.motor.is_some()
                || crosses,
            config,
        }
    }

    /// The configuration it was made from.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// Whether a press of the switch that begins in the period after this command, or goes on in it, would engage, if
    /// nothing changes: in standby, and nothing is missing but the press.
    pub fn ready(&self, command: &Command) -> bool {
        let missing = self.reactions.refusals().with(Causes::of(Cause::SwitchHeld));
        let refusing = command.causes.and(missing);
        command.mode == Mode::Standby && (refusing.is_empty() || refusing == Causes::of(Cause::SwitchOff))
    }

    /// Control periods from boot to full authority, if every sensor is good from the start and the
    /// switch is pressed at once when it may be.
    pub fn ticks_to_engage(&self) -> u32 {
        let Config { input, permit, latency, .. } = &self.config;
        let tests = u32::from(permit.self_test_ticks) + u32::from(permit.persist_ticks);
        let waits = tests + u32::from(permit.press.release_ticks) + u32::from(permit.press.press_ticks);
        let ramp = u32::from(permit.ramp_in_ticks);
        let filling = u32::from(latency.roll_rate_ticks.max(latency.speed_ticks));
        8 + input.slowest_to_qualify() + waits + ramp + filling
    }
}

/// What the controller remembers between steps. `State::default()` is a controller just started.
///
/// In this order in memory, the long history last: the chip reaches the first 1 KiB in fewer instructions.
#[derive(Clone, Debug, Default)]
#[repr(C)]
pub struct State {
    /// The time of the frame before \[us\].
    before_us: Option<u32>,
    input: InputState,
    estimate: EstimateState,
    cross: CrossState,
    response: ResponseState,
    polarity: PolarityState,
    shown_nm: f32,
    permit: PermitState,
    track: TrackState,
    shape: ShapeState,
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
    pub fn polarity(&self) -> Move {
        self.polarity.next
    }

    /// The torque the law would ask for during the polarity check, in the bicycle's sign \[N m\].
    pub fn shown_nm(&self) -> f32 {
        self.shown_nm
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

    let believed =
        input::step(&config.input, &plan.input, &plan.calibration, &mut state.input, frame, last_nm);
    let motion = motion(plan, &mut state.estimate, &believed, elapsed_us);
    let Motion { roll_rad, roll_error, force_m_s2, .. } = motion;
    state.roll = Roll { angle_rad: roll_rad, error: roll_error, force_m_s2 };
    let ahead = predict::step(&config.predict, &motion);
    let crossed =
        cross::step(&config.cross, &plan.cross, &mut state.cross, &believed, motion.roll_sin_cos, last_nm);
    if !crossed.distrusted.is_empty() {
        state.input.distrust(crossed.distrusted);
    }
    let answered = response::step(&plan.response, &mut state.response, &believed, &motion, last_nm);
    let mut causes = believed.causes.with(crossed.causes).with(answered).with(state.found);
    causes.note(Cause::Timing, elapsed_us as f32 > plan.max_gap_us);

    let speed = speed(plan, &believed, &crossed);
    let now = match (believed.gyro_rad_s(), speed) {
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
        state.shown_nm = polarity::step(&config.input, plan.period_s, &mut state.polarity, &believed, gain);
        causes.note(Cause::PolarityWrong, state.polarity.next == Move::Wrong);
    }
    let asked = permit::Asked {
        causes,
        engage: frame.engage,
        polarity_checked: !plan.check_polarity || state.polarity.next == Move::Passed,
        roll_rad: (plan.estimates && believed.gyro_rad_s().is_some())
            .then_some((motion.roll_rad, motion.roll_error)),
        rates_rad_s: [motion.roll_rate_rad_s, motion.steer_rate_rad_s],
        speed_m_s: speed.map(|v| v.newest),
        force_m_s2: motion.force_m_s2,
    };
    let permission = permit::step(&config.permit, &plan.permit, &plan.reactions, &mut state.permit, &asked);

    let (gain, law_nm, bounds) = match now {
        Some(Aligned { roll_rate_rad_s, speed }) => {
            let gain = config.law.gain_towards_zero(speed.low, speed.high);
            let mut wanted = gain * roll_rate_rad_s;
            if config.capsize.is_on() {
                wanted += config.capsize.torque(speed.low, ahead.roll_rad);
            }
            (gain, wanted, speed)
        }
        None => (0.0, 0.0, Bounds::default()),
    };
    let track_nm = config.track.as_ref().map_or(0.0, |track| {
        let seen = track::Seen {
            roll_rad: motion.roll_rad,
            steer_rad: motion.steer_rad,
            roll_rate_rad_s: motion.roll_rate_rad_s,
            steer_rate_rad_s: motion.steer_rate_rad_s,
            speed_m_s: motion.speed_m_s,
            path: believed.path().map(|[heading_rad, lateral_m]| PathError { heading_rad, lateral_m }),
            rider_torque_nm: believed.rider_torque_nm(),
            acted: state.acted,
            authority: permission.authority,
            elapsed_us,
        };
        track::step(track, &mut state.track, &seen)
    });
    let asked = shape::Asked {
        // Zero added would turn -0 into 0.
        wanted_nm: if config.track.is_some() { law_nm + track_nm } else { law_nm },
        authority: permission.authority,
        limp: permission.mode == Mode::Limp,
        speed_low_m_s: bounds.low,
        speed_high_m_s: bounds.high,
        steer_rad: believed.steer_rad(),
        steer_rate_rad_s: believed.steer_rate_rad_s(),
        rider_torque_nm: believed.rider_torque_nm(),
        elapsed_us,
    };
    let permitted = permission.mode >= Mode::Standby;
    let (shaped_nm, limits) = if permitted {
        shape::step(&config.limits, &plan.shape, &mut state.shape, &asked)
    } else {
        state.shape = ShapeState::default();
        (0.0, ActiveLimits::default())
    };
    let judged = guard::judge(&config.limits, &plan.guard, &mut state.guard, shaped_nm, permitted, &asked);
    let torque_nm = judged.unwrap_or_else(|_| {
        state.shape = ShapeState::default();
        0.0
    });
    state.acted = limits;
    state.found = judged.err().map_or(Causes::NONE, |violation| Causes::of(violation.cause()));
    Command {
        torque_nm: plan.calibration.motor(torque_nm),
        gain_nm_s_rad: if permission.authority > 0.0 { gain } else { 0.0 },
        limits,
        mode: permission.mode,
        causes: permission.causes.with(state.found),
    }
}

/// The motion from what is believed; if nothing needs more, just what the sensors say.
fn motion(plan: &Plan, state: &mut EstimateState, believed: &Believed, elapsed_us: u32) -> Motion {
    let rear = believed.rear_wheel_m_s().or(believed.front_wheel_m_s());
    let felt = Felt {
        gyro_rad_s: believed.gyro_or_zero_rad_s(),
        accel_m_s2: believed.accel_m_s2(),
        steer_rad: believed.steer_rad(),
        steer_rate_rad_s: believed.steer_rate_rad_s(),
        speed_m_s: rear.map_or(0.0, |v| v.newest),
        elapsed_us,
    };
    if plan.estimates {
        return estimate::step(&plan.config.estimate, state, &felt);
    }
    let [roll_rate_rad_s, ..] = felt.gyro_rad_s;
    Motion {
        roll_rate_rad_s,
        steer_rad: felt.steer_rad.unwrap_or(0.0),
        steer_rate_rad_s: felt.steer_rate_rad_s.unwrap_or(0.0),
        speed_m_s: felt.speed_m_s,
        roll_sin_cos: (0.0, 1.0),
        roll_error: RollError::UNKNOWN,
        force_m_s2: felt.accel_m_s2.map(estimate::size),
        ..Motion::default()
    }
}

/// Between which speeds of the scheduling wheel the truth lies: by that wheel's sensor; by the other's
/// and the steer angle while it is lost; by both when they disagree.
fn speed(plan: &Plan, believed: &Believed, crossed: &Crossed) -> Option<Bounds> {
    let disagree = crossed.causes.has(Cause::WheelsDisagree);
    let (front, rear) = (believed.front_wheel_m_s(), believed.rear_wheel_m_s());
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
            let cos =
                crossed.ground.map_or(LEAST_COS, |(_, cos)| if cos > LEAST_COS { cos } else { LEAST_COS });
            let ratio = if wheel == Wheel::Front { 1.0 / cos } else { cos };
            let other = other.spanning(other.scaled(ratio));
            Some(own.map_or(other, |own| own.spanning(other)))
        }
    }
}

/// Cosine of the largest steer angle on the ground that is reckoned with while it is not known.
const LEAST_COS: f32 = 0.4;
