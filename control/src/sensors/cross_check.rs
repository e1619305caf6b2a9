//! Sensors against each other: what no single sensor can know to be wrong.
//!
//! The relations are the kinematics of a bicycle that rolls without slip, pitch and the contacts'
//! wandering left out. Inside the basins of `h`, alone and with riders, that leaves up to 0.30 m/s
//! between the wheels and 0.83 rad/s of yaw unexplained (`data/motion.toml`); the tolerances must lie above.

mod repeats;
mod steering;

use crate::estimate::Place;
use crate::fault::{Cause, Causes};
use crate::maths::{max, min, rsqrt, sin_cos};
use crate::param::{ParamSpec, ParamVisitor};
use crate::sensors::validation::Measurements;
use repeats::Repeats;
pub use steering::{MOVES_M_S, RIDING_M_S, ROLL_WRONG, YAW_WRONG};
use steering::{Steering, SteeringPlan};

/// In which control period of a stretch of [`steering`], and of its second half, is a look of [`repeats`]: one in which neither
/// that stretch nor one of `response` ends, so that no period has to do both.
const REPEATS_TICK: u16 = 6;

/// The tolerances. Each check is off by default.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossCheckConfig {
    /// Wheelbase \[m\].
    pub wheelbase_m: f32,
    /// Steer axis tilt \[rad\].
    pub tilt_rad: f32,
    /// Largest difference of front wheel speed times the cosine of the steer angle on the ground from
    /// the rear wheel's speed \[m/s\].
    pub wheels_m_s: Option<f32>,
    /// Largest difference of the yaw rate from the one that speed and steer angle make \[rad/s\].
    pub yaw_rad_s: Option<f32>,
    /// A smaller one that must not last for [`CrossCheckConfig::slow_ticks`]: gentle riding shows a wrong sensor by little.
    pub yaw_slow_rad_s: Option<f32>,
    /// Whether the sign of the yaw rate is judged by how it changes with the steer angle, and a wheel that stands by the yaw rate.
    pub yaw_slope: bool,
    /// Whether the sign of the roll rate is judged by how the roll follows from steering.
    pub roll_correlation: bool,
    /// Largest difference of the turned steer angle from the summed steer rate \[rad\].
    pub steer_rad: Option<f32>,
    /// Largest difference of the drive's torque from what it was asked for in the last periods \[N m\].
    pub motor_nm: Option<f32>,
    /// How long a difference must last \[control periods\].
    pub persist_ticks: u16,
    /// How long the small difference of the yaw rate must last \[control periods\].
    pub slow_ticks: u16,
    /// How often in a row, every 24 ms, gyro or accelerometer may be found to say the same on all three axes while the bicycle
    /// rides and another sensor changes; 0 is any number. Noise makes every sample of three axes another one; a sensor that
    /// filters its noise away below its quantum needs more.
    pub same_checks: u16,
}

impl Default for CrossCheckConfig {
    /// All off; the geometry of a city bicycle.
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
    /// Shows every parameter.
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

/// What follows from the parameters and the rate of calls alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossCheckPlan {
    period_s: f32,
    per_wheelbase: f32,
    tilt_sin_cos: (f32, f32),
    /// The tolerances, infinite where a check is off \[m/s, rad/s, rad, N m\].
    wheels_m_s: f32,
    yaw_rad_s: f32,
    yaw_slow_rad_s: f32,
    steer_rad: f32,
    motor_nm: f32,
    steering: SteeringPlan,
    /// The second of the two control periods of a stretch in which there is a look; [`REPEATS_TICK`] is the first.
    second_repeats_tick: u16,
}

impl CrossCheckPlan {
    /// For a mass at this place and `rate_hz` calls a second.
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
            second_repeats_tick: REPEATS_TICK + steering.stretch_ticks / 2,
        }
    }
}

/// What the checks remember.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CrossCheckState {
    wheels: Debounce,
    yaw: Debounce,
    yaw_slow: Debounce,
    steer: Debounce,
    motor: Debounce,
    /// Steer angle less the summed steer rate, drifting slowly to the present one \[rad\].
    offset_rad: Option<f32>,
    /// Least and largest torque asked for in the last periods \[N m\].
    asked_nm: (f32, f32),
    /// The differences of this period.
    residuals: Residuals,
    steering: Steering,
    /// Whether a difference of the wheels has lasted, and one of the yaw rate.
    wheels_wrong: bool,
    yaw_wrong: bool,
    /// The control period of a stretch.
    tick: u16,
    repeats: Repeats,
}

impl CrossCheckState {
    /// The differences of the last period.
    pub fn residuals(&self) -> Residuals {
        self.residuals
    }

    /// How much of what it should do the yaw rate does: 1 all, -1 the opposite; `None` while too little happens.
    pub fn yaw_slope(&self) -> Option<f32> {
        self.steering.yaw_slope()
    }

    /// How well the roll follows from steering: 1 if exactly, -1 if in everything the other way; `None` while too little
    /// happens.
    pub fn roll_correlation(&self) -> Option<f32> {
        self.steering.roll_correlation()
    }

    /// The yaw rate as speed and steer angle make it, and as the gyro measures it; `None` where one of them is not known.
    #[inline]
    fn yaw(
        plan: &CrossCheckPlan,
        measurements: &Measurements,
        [front, rear]: [Option<f32>; 2],
        ground: Option<(f32, f32)>,
        (sin_roll, cos_roll): (f32, f32),
    ) -> Option<Yaw> {
        // The front wheel moves sideways by its speed times the sine; without it the rear one must do.
        let (speed_m_s, per_speed) = match (front, rear, ground) {
            (Some(front), _, Some((sin, _))) => (front, sin),
            (None, Some(rear), Some((sin, cos))) if cos > 0.2 => (rear, sin / cos),
            _ => return None,
        };
        let [x, y, z] = measurements.gyro_rad_s()?;
        let per_speed = per_speed * plan.per_wheelbase;
        Some(Yaw { speed_m_s, per_speed, measured_rad_s: y * sin_roll + z * cos_roll, roll_rad_s: x })
    }
}

/// The yaw rate as speed and steer angle make it, and as measured.
struct Yaw {
    /// Speed of the wheel whose path it is \[m/s\].
    speed_m_s: f32,
    /// The yaw rate of each m/s \[rad/m\].
    per_speed: f32,
    /// About the vertical \[rad/s\].
    measured_rad_s: f32,
    /// The roll rate beside it \[rad/s\].
    roll_rad_s: f32,
}

/// By how much sensors differ from what the others say; NaN where there is nothing to compare.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residuals {
    /// Of the wheels, [`CrossCheckConfig::wheels_m_s`].
    pub wheels_m_s: f32,
    /// Of the yaw rate, [`CrossCheckConfig::yaw_rad_s`].
    pub yaw_rad_s: f32,
    /// Of the steer angle, [`CrossCheckConfig::steer_rad`].
    pub steer_rad: f32,
    /// Of the drive's torque, [`CrossCheckConfig::motor_nm`].
    pub motor_nm: f32,
}

impl Default for Residuals {
    /// Nothing was compared yet.
    fn default() -> Self {
        let none = f32::NAN;
        Self { wheels_m_s: none, yaw_rad_s: none, steer_rad: none, motor_nm: none }
    }
}

/// Counts how long something lasts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Debounce(u16);

impl Debounce {
    /// Whether a `difference` beyond the `limit`, looked at every so many `ticks`, has lasted longer than allowed. NaN, what can't be
    /// compared, breaks off the count.
    fn beyond(&mut self, limit: f32, difference: f32, persist_ticks: u16, ticks: u16) -> bool {
        if difference.abs() > limit {
            self.0 = self.0.saturating_add(ticks);
            self.0 > persist_ticks
        } else {
            self.0 = 0;
            false
        }
    }
}

/// What the checks found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CrossCheckResult {
    /// The disagreements that have lasted.
    pub causes: Causes,
    /// Sensors of these causes, found in this period, are not to be believed from now on.
    pub invalidated: Causes,
    /// Of [`on_the_ground`], if the steer angle is known.
    pub ground: Option<(f32, f32)>,
}

/// How quickly the sums forget: the part of the difference that one period takes away.
const FORGET: f32 = 1.0 / 256.0;

/// One control period: the sensors, sine and cosine of the roll angle as estimated, and the torque asked for in
/// the period before, in the bicycle's sign \[N m\].
pub fn step(
    config: &CrossCheckConfig,
    plan: &CrossCheckPlan,
    state: &mut CrossCheckState,
    measurements: &Measurements,
    roll_sin_cos: (f32, f32),
    torque_nm: f32,
) -> CrossCheckResult {
    let persist = config.persist_ticks;
    state.tick = if state.tick < plan.steering.stretch_ticks { state.tick + 1 } else { 1 };
    let front = measurements.front_wheel_m_s().map(|v| v.newest);
    let rear = measurements.rear_wheel_m_s().map(|v| v.newest);
    let mut invalidated = Causes::NONE;
    if (state.tick == REPEATS_TICK || state.tick == plan.second_repeats_tick) && config.same_checks > 0 {
        // Where nothing is known nothing is the same.
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

    // Every fourth period will do for the yaw rate and for the wheels, those between the ends of stretches, and each of
    // them does a part.
    if state.tick % 4 == 3 {
        // A bicycle led or turned by hand need not roll where its front wheel points.
        match CrossCheckState::yaw(plan, measurements, [front, rear], ground, roll_sin_cos) {
            Some(Yaw { speed_m_s, per_speed, measured_rad_s, roll_rad_s }) => {
                state.steering.add(rear.unwrap_or(speed_m_s), per_speed, measured_rad_s, roll_rad_s);
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
        let now = CrossCheckState::yaw(plan, measurements, [front, rear], ground, roll_sin_cos);
        let yaw = now.map_or(f32::NAN, |now| now.measured_rad_s - now.speed_m_s * now.per_speed);
        let riding = if state.steering.rides() { yaw } else { f32::NAN };
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
            let difference = angle - expected;
            state.offset_rad = Some(expected + FORGET * difference);
            difference
        }
        _ => {
            state.offset_rad = None;
            f32::NAN
        }
    };
    causes.note(Cause::SteerDisagrees, state.steer.beyond(plan.steer_rad, steer, persist, 1));

    let (low, high) = state.asked_nm;
    let motor = match measurements.motor_torque_nm() {
        Some(given) if given > high => given - high,
        Some(given) if given < low => given - low,
        Some(_) => 0.0,
        None => f32::NAN,
    };
    causes.note(Cause::MotorDisagrees, state.motor.beyond(plan.motor_nm, motor, persist, 1));
    let residuals = &mut state.residuals;
    (residuals.steer_rad, residuals.motor_nm) = (steer, motor);
    let closer = |bound: f32| bound + 4.0 * FORGET * (torque_nm - bound);
    state.asked_nm = (min(torque_nm, closer(low)), max(torque_nm, closer(high)));
    CrossCheckResult { causes, invalidated, ground }
}

/// Sine and cosine of the angle between the front wheel's and the rear frame's tracks on the ground:
/// the steer angle turned about the tilted axis, leaned by an angle of which sine and cosine are given.
pub fn on_the_ground(plan: &CrossCheckPlan, roll_sin_cos: (f32, f32), steer_rad: f32) -> (f32, f32) {
    let ((sin_tilt, cos_tilt), (sin_roll, cos_roll)) = (plan.tilt_sin_cos, roll_sin_cos);
    let (sin_steer, cos_steer) = sin_cos(steer_rad);
    let (across, along) = (cos_tilt * sin_steer, cos_steer * cos_roll - sin_tilt * sin_steer * sin_roll);
    let square = across * across + along * along;
    if square > 1e-6 {
        let per = rsqrt(square);
        (across * per, along * per)
    } else {
        (0.0, 1.0)
    }
}
