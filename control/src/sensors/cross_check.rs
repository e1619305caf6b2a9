//! Cross-checks between sensors: detect faults that no single sensor's monitor can detect.
//!
//! The relations are the kinematics of a bicycle that rolls without slip; pitch and the motion of the contact points
//! are neglected. Inside the basins of `h`, without and with riders, that leaves residuals up to 0.30 m/s between the
//! wheels and 0.83 rad/s of yaw rate (`data/motion.toml`); the tolerances must be larger.

mod repeats;
mod steering;

use crate::estimate::Place;
use crate::fault::{Cause, Causes};
use crate::maths::{max, min, rsqrt, sin_cos};
use crate::param::{ParamSpec, ParamVisitor};
use crate::sensors::measurements::Measurements;
use repeats::Repeats;
pub use steering::{MOVING_M_S, RIDING_M_S, ROLL_WRONG, YAW_WRONG};
use steering::{Steering, SteeringPlan};

/// Control period of a block of [`steering`] in which [`repeats`] runs, and again half a block later. Neither that
/// block nor one of `sign_check` ends in it, so the work is spread over the periods.
const REPEATS_TICK: u16 = 6;

/// Tolerances of the cross-checks. Each check is off by default.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossCheckConfig {
    /// Wheelbase \[m\].
    pub wheelbase_m: f32,
    /// Steer axis tilt \[rad\].
    pub tilt_rad: f32,
    /// Tolerance of front wheel speed times the cosine of the ground steer angle, less rear wheel speed \[m/s\].
    pub wheels_m_s: Option<f32>,
    /// Tolerance of the measured yaw rate less the one expected from speed and steer angle \[rad/s\].
    pub yaw_rad_s: Option<f32>,
    /// Smaller yaw rate tolerance, for a residual that lasts [`CrossCheckConfig::slow_ticks`]: in gentle riding a
    /// faulty sensor causes a small residual.
    pub yaw_slow_rad_s: Option<f32>,
    /// Whether to check the sign of the yaw rate by its slope over the steering-induced yaw rate, and a standing wheel
    /// by the yaw rate.
    pub yaw_slope: bool,
    /// Whether to check the sign of the roll rate by the correlation of roll acceleration with steering.
    pub roll_correlation: bool,
    /// Tolerance of the steer angle less the integrated steer rate \[rad\].
    pub steer_rad: Option<f32>,
    /// Tolerance of the drive's reported torque outside the range requested in the last periods \[N m\].
    pub motor_nm: Option<f32>,
    /// Persistence of a residual before it is reported \[control periods\].
    pub persist_ticks: u16,
    /// Persistence of the small yaw rate residual \[control periods\].
    pub slow_ticks: u16,
    /// Consecutive checks, 24 ms apart, that find gyro or accelerometer unchanged on all three axes while the bicycle
    /// rides and another sensor changes. 0 turns these checks off, and with them that of the rear wheel's jump. Noise
    /// changes every sample of three axes; a sensor that filters its noise below its resolution needs more checks.
    pub same_checks: u16,
}

impl Default for CrossCheckConfig {
    /// All checks off; the geometry of a city bicycle.
    fn default() -> Self {
        Self {
            wheelbase_m: 1.06,
            tilt_rad: 0.32,
            wheels_m_s: None,
            yaw_rad_s: None,
            yaw_slow_rad_s: None,
            yaw_slope: false,
            roll_correlation: false,
            steer_rad: None,
            motor_nm: None,
            persist_ticks: 0,
            slow_ticks: 0,
            same_checks: 0,
        }
    }
}

impl CrossCheckConfig {
    /// Whether a check needs the estimated roll angle: those of the wheels, the yaw rate and the roll.
    pub fn needs_motion(&self) -> bool {
        self.wheels_m_s.is_some()
            || self.yaw_rad_s.is_some()
            || self.yaw_slow_rad_s.is_some()
            || self.yaw_slope
            || self.roll_correlation
    }

    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        let g = "cross";
        to.number(&ParamSpec::new(g, "wheelbase_m", 0.1, 5.0), &mut self.wheelbase_m);
        to.number(&ParamSpec::new(g, "tilt_rad", -1.0, 1.4), &mut self.tilt_rad);
        to.optional_number(&ParamSpec::new(g, "wheels_m_s", 0.01, 10.0), &mut self.wheels_m_s);
        to.optional_number(&ParamSpec::new(g, "yaw_rad_s", 0.01, 20.0), &mut self.yaw_rad_s);
        to.optional_number(&ParamSpec::new(g, "yaw_slow_rad_s", 0.01, 20.0), &mut self.yaw_slow_rad_s);
        to.switch(&ParamSpec::switch(g, "yaw_slope"), &mut self.yaw_slope);
        to.switch(&ParamSpec::switch(g, "roll_correlation"), &mut self.roll_correlation);
        to.optional_number(&ParamSpec::new(g, "steer_rad", 0.001, 3.0), &mut self.steer_rad);
        to.optional_number(&ParamSpec::new(g, "motor_nm", 0.01, 50.0), &mut self.motor_nm);
        to.count(&ParamSpec::new(g, "persist_ticks", 0.0, 1000.0), &mut self.persist_ticks);
        to.count(&ParamSpec::new(g, "slow_ticks", 0.0, 10_000.0), &mut self.slow_ticks);
        to.count(&ParamSpec::new(g, "same_checks", 0.0, 1000.0), &mut self.same_checks);
    }
}

/// Constants derived from the parameters and the call rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossCheckPlan {
    period_s: f32,
    per_wheelbase: f32,
    tilt_sin_cos: (f32, f32),
    /// Tolerances, infinite where a check is off \[m/s, rad/s, rad, N m\].
    wheels_m_s: f32,
    yaw_rad_s: f32,
    yaw_slow_rad_s: f32,
    steer_rad: f32,
    motor_nm: f32,
    steering: SteeringPlan,
    /// Second control period of a block in which [`repeats`] runs; [`REPEATS_TICK`] is the first.
    second_repeats_tick: u16,
}

impl CrossCheckPlan {
    /// For a centre of mass `mass` and `rate_hz` calls per second.
    pub fn new(config: &CrossCheckConfig, mass: &Place, rate_hz: f32) -> Self {
        let steering = SteeringPlan::new(config.yaw_slope, config.roll_correlation, mass, rate_hz);
        Self {
            period_s: 1.0 / rate_hz,
            per_wheelbase: 1.0 / config.wheelbase_m,
            tilt_sin_cos: sin_cos(config.tilt_rad),
            wheels_m_s: config.wheels_m_s.unwrap_or(f32::INFINITY),
            yaw_rad_s: config.yaw_rad_s.unwrap_or(f32::INFINITY),
            yaw_slow_rad_s: config.yaw_slow_rad_s.unwrap_or(f32::INFINITY),
            steer_rad: config.steer_rad.unwrap_or(f32::INFINITY),
            motor_nm: config.motor_nm.unwrap_or(f32::INFINITY),
            steering,
            second_repeats_tick: REPEATS_TICK + steering.block_ticks / 2,
        }
    }
}

/// State of the cross-checks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct CrossCheckState {
    wheels: Debounce,
    yaw: Debounce,
    yaw_slow: Debounce,
    steer: Debounce,
    motor: Debounce,
    /// Integrated steer rate, corrected slowly towards the steer angle \[rad\].
    offset_rad: Option<f32>,
    /// Smallest and largest torque requested in the last periods \[N m\].
    requested_nm: (f32, f32),
    /// Residuals of this period.
    residuals: Residuals,
    steering: Steering,
    /// Whether a residual of the wheels has persisted, and one of the yaw rate.
    wheels_wrong: bool,
    yaw_wrong: bool,
    /// Control period within a block.
    tick: u16,
    repeats: Repeats,
}

impl CrossCheckState {
    /// Residuals of the last period.
    pub fn residuals(&self) -> Residuals {
        self.residuals
    }

    /// Slope of the measured over the expected yaw rate: 1 as expected, -1 reversed; `None` while the excitation is too
    /// small.
    pub fn yaw_slope(&self) -> Option<f32> {
        self.steering.yaw_slope()
    }

    /// Correlation of the measured with the steering-induced roll acceleration, -1 to 1; `None` while the excitation is
    /// too small.
    pub fn roll_correlation(&self) -> Option<f32> {
        self.steering.roll_correlation()
    }

    /// Yaw rate expected from speed and steer angle, and measured by the gyro; `None` if an input is missing.
    #[inline]
    fn yaw(
        plan: &CrossCheckPlan,
        measurements: &Measurements,
        [front, rear]: [Option<f32>; 2],
        ground: Option<(f32, f32)>,
        (sin_roll, cos_roll): (f32, f32),
    ) -> Option<Yaw> {
        // The front contact moves sideways at its speed times the sine; without a front wheel sensor the rear wheel's
        // speed is used.
        let (speed_m_s, ratio) = match (front, rear, ground) {
            (Some(front), _, Some((sin, _))) => (front, sin),
            (None, Some(rear), Some((sin, cos))) if cos > 0.2 => (rear, sin / cos),
            _ => return None,
        };
        let [x, y, z] = measurements.gyro_rad_s()?;
        let yaw_rad_m = ratio * plan.per_wheelbase;
        Some(Yaw { speed_m_s, yaw_rad_m, measured_rad_s: y * sin_roll + z * cos_roll, roll_rad_s: x })
    }
}

/// Expected and measured yaw rate.
struct Yaw {
    /// Speed of the wheel from which the expected rate is computed \[m/s\].
    speed_m_s: f32,
    /// Expected yaw rate per speed of that wheel \[rad/m\].
    yaw_rad_m: f32,
    /// Measured yaw rate about the vertical \[rad/s\].
    measured_rad_s: f32,
    /// Measured roll rate \[rad/s\].
    roll_rad_s: f32,
}

/// Residuals of the cross-checks; NaN where a sensor is missing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct Residuals {
    /// Wheel speeds, see [`CrossCheckConfig::wheels_m_s`].
    pub wheels_m_s: f32,
    /// Yaw rate, see [`CrossCheckConfig::yaw_rad_s`].
    pub yaw_rad_s: f32,
    /// Steer angle, see [`CrossCheckConfig::steer_rad`].
    pub steer_rad: f32,
    /// Drive torque, see [`CrossCheckConfig::motor_nm`].
    pub motor_nm: f32,
}

impl Default for Residuals {
    /// No comparison yet.
    fn default() -> Self {
        let none = f32::NAN;
        Self { wheels_m_s: none, yaw_rad_s: none, steer_rad: none, motor_nm: none }
    }
}

/// Counts how long a residual persists \[control periods\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
struct Debounce(u16);

impl Debounce {
    /// Whether a `residual` beyond the `limit`, checked every `ticks` periods, has lasted longer than `persist_ticks`.
    /// NaN (no comparison) resets the count.
    fn beyond(&mut self, limit: f32, residual: f32, persist_ticks: u16, ticks: u16) -> bool {
        if residual.abs() > limit {
            self.0 = self.0.saturating_add(ticks);
            self.0 > persist_ticks
        } else {
            self.0 = 0;
            false
        }
    }
}

/// Result of the cross-checks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CrossCheckResult {
    /// Causes of all checks: persistent residuals, slopes, correlation, and those of `invalidated`.
    pub causes: Causes,
    /// Causes whose sensors must be invalidated from now on.
    pub invalidated: Causes,
    /// Sine and cosine of the ground steer angle, see [`on_the_ground`]; `None` without a steer angle.
    pub ground: Option<(f32, f32)>,
}

/// Leak of the integrators per period, as a fraction of the residual.
const LEAK: f32 = 1.0 / 256.0;

/// One control period. `roll_sin_cos` is sine and cosine of the estimated roll angle, `torque_nm` the torque requested
/// in the previous period, in the bicycle's sign \[N m\].
pub fn step(
    config: &CrossCheckConfig,
    plan: &CrossCheckPlan,
    state: &mut CrossCheckState,
    measurements: &Measurements,
    roll_sin_cos: (f32, f32),
    torque_nm: f32,
) -> CrossCheckResult {
    let persist = config.persist_ticks;
    state.tick = if state.tick < plan.steering.block_ticks { state.tick + 1 } else { 1 };
    let front = measurements.front_wheel_m_s().map(|v| v.newest);
    let rear = measurements.rear_wheel_m_s().map(|v| v.newest);
    let mut invalidated = Causes::NONE;
    if (state.tick == REPEATS_TICK || state.tick == plan.second_repeats_tick) && config.same_checks > 0 {
        // A missing sensor never compares equal.
        let unknown = [f32::NAN; 3];
        let [wx, wy, wz] = measurements.gyro_rad_s().unwrap_or(unknown);
        let [fx, fy, fz] = measurements.accel_m_s2().unwrap_or(unknown);
        let steer_rad = measurements.steer_rad().unwrap_or(0.0);
        let (front_m_s, rear_m_s) = (front.unwrap_or(0.0), rear.unwrap_or(f32::NAN));
        invalidated =
            state.repeats.check(config.same_checks, wx, wy, wz, fx, fy, fz, steer_rad, front_m_s, rear_m_s);
    }
    let mut causes = invalidated;
    let ground = measurements.steer_rad().map(|steer| on_the_ground(plan, roll_sin_cos, steer));

    // Yaw rate and wheels are checked every fourth period each, in different periods between the ends of blocks.
    if state.tick % 4 == 3 {
        // A bicycle led or turned by hand does not have to roll where its front wheel points.
        match CrossCheckState::yaw(plan, measurements, [front, rear], ground, roll_sin_cos) {
            Some(Yaw { speed_m_s, yaw_rad_m, measured_rad_s, roll_rad_s }) => {
                state.steering.add(rear.unwrap_or(speed_m_s), yaw_rad_m, measured_rad_s, roll_rad_s);
            }
            None => state.steering = Steering::default(),
        }
        let wheels = match (front, rear, ground) {
            (Some(front), Some(rear), Some((_, cos))) => front * cos - rear,
            _ => f32::NAN,
        };
        state.residuals.wheels_m_s = wheels;
        state.wheels_wrong = state.wheels.beyond(plan.wheels_m_s, wheels, persist, 4);
    } else if state.tick % 4 == 1 {
        let yaw_rates = CrossCheckState::yaw(plan, measurements, [front, rear], ground, roll_sin_cos);
        let yaw = yaw_rates.map_or(f32::NAN, |yaw| yaw.measured_rad_s - yaw.speed_m_s * yaw.yaw_rad_m);
        let riding = if state.steering.is_riding() { yaw } else { f32::NAN };
        state.residuals.yaw_rad_s = yaw;
        state.yaw_wrong = state.yaw.beyond(plan.yaw_rad_s, yaw, persist, 4)
            | state.yaw_slow.beyond(plan.yaw_slow_rad_s, riding, config.slow_ticks, 4);
    } else if state.tick == steering::END_TICK {
        state.steering.end(&plan.steering, rear.or(front).unwrap_or(0.0), rear.is_some());
    } else if state.tick == steering::ROLL_TICK {
        state.steering.check_roll(&plan.steering);
    }
    causes.note(Cause::WheelsDisagree, state.wheels_wrong);
    causes.note(Cause::YawDisagrees, state.yaw_wrong);
    causes = causes.with(state.steering.causes());

    let steer = match (measurements.steer_rad(), measurements.steer_rate_rad_s()) {
        (Some(angle), Some(rate)) => {
            let expected = state.offset_rad.unwrap_or(angle) + rate * plan.period_s;
            let residual = angle - expected;
            state.offset_rad = Some(expected + LEAK * residual);
            residual
        }
        _ => {
            state.offset_rad = None;
            f32::NAN
        }
    };
    causes.note(Cause::SteerDisagrees, state.steer.beyond(plan.steer_rad, steer, persist, 1));

    let (low, high) = state.requested_nm;
    let motor = match measurements.motor_torque_nm() {
        Some(reported) if reported > high => reported - high,
        Some(reported) if reported < low => reported - low,
        Some(_) => 0.0,
        None => f32::NAN,
    };
    causes.note(Cause::MotorDisagrees, state.motor.beyond(plan.motor_nm, motor, persist, 1));
    let residuals = &mut state.residuals;
    (residuals.steer_rad, residuals.motor_nm) = (steer, motor);
    let decayed = |bound: f32| bound + 4.0 * LEAK * (torque_nm - bound);
    state.requested_nm = (min(torque_nm, decayed(low)), max(torque_nm, decayed(high)));
    CrossCheckResult { causes, invalidated, ground }
}

/// Sine and cosine of the ground steer angle, between the front wheel's and the rear frame's tracks: the steer angle
/// about the tilted steer axis, of a frame leaned by the roll angle whose sine and cosine are given.
pub fn on_the_ground(plan: &CrossCheckPlan, roll_sin_cos: (f32, f32), steer_rad: f32) -> (f32, f32) {
    let ((sin_tilt, cos_tilt), (sin_roll, cos_roll)) = (plan.tilt_sin_cos, roll_sin_cos);
    let (sin_steer, cos_steer) = sin_cos(steer_rad);
    let (across, along) = (cos_tilt * sin_steer, cos_steer * cos_roll - sin_tilt * sin_steer * sin_roll);
    let square = across * across + along * along;
    if square > 1e-6 {
        let per_length = rsqrt(square);
        (across * per_length, along * per_length)
    } else {
        (0.0, 1.0)
    }
}
