//! Margin of each check in a replay: the largest residual that lasted for the check's debounce time, against the
//! threshold.

use crate::plant::Sensor;
use control::sensors::cross_check::{ROLL_WRONG, YAW_WRONG};
use control::sensors::sign_check::{GYRO_WRONG, MOTOR_WRONG};
use control::{Config, SensorFrame, State};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::VecDeque;

/// One check's margin.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Check {
    /// Its name.
    pub name: &'static str,
    /// The compared quantity, with its unit.
    pub residual: &'static str,
    /// The largest residual that lasted; null without values to compare.
    pub largest_residual: Option<f64>,
    /// Time at which it had lasted \[s\].
    pub at_s: Option<f64>,
    /// Threshold of the check; null if it is switched off.
    pub limit: Option<f64>,
    /// Time that a residual must last to count \[control periods\].
    pub lasts_ticks: u16,
}

/// The largest so far of the minimum over the last few values.
#[derive(Clone, Debug)]
struct Sustained {
    check: Check,
    /// Rising values with their positions; the first is the minimum of the window.
    window: VecDeque<(u64, f64)>,
    /// Number of consecutive values, and of all values.
    run: u64,
    count: u64,
}

impl Sustained {
    fn new(name: &'static str, residual: &'static str, limit: Option<f32>, lasts_ticks: u16) -> Self {
        let limit = limit.map(f64::from).filter(|limit| limit.is_finite());
        let check = Check { name, residual, largest_residual: None, at_s: None, limit, lasts_ticks };
        Self { check, window: VecDeque::new(), run: 0, count: 0 }
    }

    /// Adds a residual; NaN (no value to compare) ends a run of consecutive values.
    fn take(&mut self, t_s: f64, residual: f64) {
        self.count += 1;
        if residual.is_nan() {
            (self.run, self.window) = (0, VecDeque::new());
            return;
        }
        self.run += 1;
        while self.window.back().is_some_and(|(_, value)| *value >= residual) {
            self.window.pop_back();
        }
        self.window.push_back((self.count, residual));
        let length = u64::from(self.check.lasts_ticks) + 1;
        while self.window.front().is_some_and(|(at, _)| at + length <= self.count) {
            self.window.pop_front();
        }
        let least = self.window.front().map_or(f64::NAN, |(_, value)| *value);
        if self.run >= length && self.check.largest_residual.is_none_or(|largest| least > largest) {
            (self.check.largest_residual, self.check.at_s) = (Some(least), Some(t_s));
        }
    }
}

/// The margins of all checks during a replay.
#[derive(Clone, Debug)]
pub(super) struct Checks {
    lasting: Vec<Sustained>,
    limits: Vec<SensorLimits>,
    before: Vec<Option<Before>>,
}

/// Limits of the checks of one sensor.
#[derive(Clone, Copy, Debug)]
struct SensorLimits {
    sensor: Sensor,
    step: f64,
    slope_per_s: Option<f64>,
    period_s: f64,
}

/// A sensor's previous sample, and how many control periods ago it came.
#[derive(Clone, Copy, Debug)]
struct Before {
    value: [f64; 3],
    ticks: u32,
}

const YAW_RESIDUAL: &str = "yaw rate less that of speed and steer angle [rad/s]";
const SLOPE: &str = "slope with its sign changed";
const CORRELATION: &str = "correlation with its sign changed";

/// Number of checks of one sensor: range, jump and age, in this order.
const OF_SENSOR: usize = 3;

impl Checks {
    /// The checks of a configuration.
    pub(super) fn new(config: &Config) -> Self {
        let (mut lasting, mut limits) = (Vec::new(), Vec::new());
        for sensor in Sensor::ALL {
            let Some((names, declared)) = named(config, sensor) else { continue };
            if !declared.fitted {
                continue;
            }
            let [range, jump, age] = names;
            lasting.push(Sustained::new(range, "largest magnitude of an axis, SI", Some(declared.max), 0));
            let jumps = declared.slope_per_s.map(|_| 1.0);
            lasting.push(Sustained::new(
                jump,
                "change between two samples, as a part of the largest accepted",
                jumps,
                0,
            ));
            let timeout = Some(f32::from(declared.timeout_ticks));
            lasting.push(Sustained::new(age, "age of the newest sample [control periods]", timeout, 0));
            limits.push(SensorLimits {
                sensor,
                step: f64::from(declared.step),
                slope_per_s: declared.slope_per_s.map(f64::from),
                period_s: 1.0 / f64::from(config.rate_hz),
            });
        }
        let c = &config.cross;
        let p = &config.permit;
        let slope = |on: bool, wrong: f32| on.then_some(-wrong);
        let motor = c.motor_nm;
        let (gyro_response, motor_response) = (config.response.gyro, config.response.motor.is_some());
        let lifted = p.lifted_m_s2.map(|least| 9.81 - least);
        lasting.extend([
            Sustained::new("wheels", "difference of the wheels' speeds [m/s]", c.wheels_m_s, c.persist_ticks),
            Sustained::new("yaw", YAW_RESIDUAL, c.yaw_rad_s, c.persist_ticks),
            Sustained::new("yaw, lasting", YAW_RESIDUAL, c.yaw_slow_rad_s, c.slow_ticks),
            Sustained::new("yaw slope", SLOPE, slope(c.yaw_slope, YAW_WRONG), 0),
            Sustained::new("roll correlation", CORRELATION, slope(c.roll_correlation, ROLL_WRONG), 0),
            Sustained::new(
                "steer",
                "steer angle less the summed steer rate [rad]",
                c.steer_rad,
                c.persist_ticks,
            ),
            Sustained::new("motor", "drive's torque beyond the requested one [N m]", motor, c.persist_ticks),
            Sustained::new("gyro response", SLOPE, slope(gyro_response, GYRO_WRONG), 0),
            Sustained::new("motor response", SLOPE, slope(motor_response, MOTOR_WRONG), 0),
            Sustained::new("fallen", "roll angle less its bound [rad]", p.fallen_rad, p.persist_ticks),
            Sustained::new("roll bound", "bound of the roll angle [rad]", p.roll_unknown_rad, 0),
            Sustained::new("crash", "specific force [m/s^2]; a fast rate must come with it", p.crash_m_s2, 0),
            Sustained::new("lifted", "9.81 less the specific force [m/s^2]", lifted, p.persist_ticks),
        ]);
        let before = vec![None; limits.len()];
        Self { lasting, limits, before }
    }

    /// Adds a control period: the controller's input, and its state after the step.
    pub(super) fn take(&mut self, t_s: f64, frame: &SensorFrame, state: &State) {
        let (own, common) = self.lasting.split_at_mut(OF_SENSOR * self.limits.len());
        for ((limits, before), checks) in
            self.limits.iter().zip(&mut self.before).zip(own.chunks_mut(OF_SENSOR))
        {
            let (value, age) = sample_of(frame, limits.sensor);
            if let Some(before) = before {
                before.ticks += 1;
            }
            if age == 0 {
                let size = value.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
                checks[0].take(t_s, size);
                if let (Some(last), Some(slope)) = (*before, limits.slope_per_s) {
                    let change =
                        value.iter().zip(last.value).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
                    let allowed = limits.step + slope * f64::from(last.ticks) * limits.period_s;
                    checks[1].take(t_s, change / allowed);
                }
                *before = Some(Before { value, ticks: 0 });
            }
            if before.is_some() {
                checks[2].take(t_s, f64::from(age));
            }
        }
        let residuals = state.residuals();
        let roll = state.roll();
        let [gyro, motor] = state.slopes().map(|slope| slope.map_or(f64::NAN, |slope| -f64::from(slope)));
        let force = roll.force_m_s2.map_or(f64::NAN, |force| 9.81 - f64::from(force));
        let values = [
            f64::from(residuals.wheels_m_s).abs(),
            f64::from(residuals.yaw_rad_s).abs(),
            f64::from(residuals.yaw_rad_s).abs(),
            state.yaw_slope().map_or(f64::NAN, |slope| -f64::from(slope)),
            state.roll_correlation().map_or(f64::NAN, |correlation| -f64::from(correlation)),
            f64::from(residuals.steer_rad).abs(),
            f64::from(residuals.motor_nm).abs(),
            gyro,
            motor,
            f64::from(roll.angle_rad).abs() - f64::from(roll.error.bound_rad()),
            f64::from(roll.error.bound_rad()),
            roll.force_m_s2.map_or(f64::NAN, f64::from),
            force,
        ];
        for (check, value) in common.iter_mut().zip(values) {
            check.take(t_s, value);
        }
    }

    /// The margins.
    pub(super) fn done(self) -> Vec<Check> {
        self.lasting.into_iter().map(|lasting| lasting.check).collect()
    }
}

/// Names of the checks of one sensor, and its declaration; `None` for the path.
fn named(config: &Config, sensor: Sensor) -> Option<([&'static str; OF_SENSOR], &control::Sensor)> {
    let input = &config.input;
    Some(match sensor {
        Sensor::Gyro => (["gyro range", "gyro jump", "gyro age"], &input.gyro),
        Sensor::Accel => (["accel range", "accel jump", "accel age"], &input.accel),
        Sensor::Steer => (["steer range", "steer jump", "steer age"], &input.steer),
        Sensor::SteerRate => (["steer rate range", "steer rate jump", "steer rate age"], &input.steer_rate),
        Sensor::FrontWheel => {
            (["front wheel range", "front wheel jump", "front wheel age"], &input.front_wheel)
        }
        Sensor::RearWheel => (["rear wheel range", "rear wheel jump", "rear wheel age"], &input.rear_wheel),
        Sensor::RiderTorque => {
            (["rider torque range", "rider torque jump", "rider torque age"], &input.rider_torque)
        }
        Sensor::MotorReport => (["motor range", "motor jump", "motor age"], &input.motor),
        Sensor::Path => return None,
    })
}

/// A sensor's sample in a frame, and its age.
fn sample_of(frame: &SensorFrame, sensor: Sensor) -> ([f64; 3], u16) {
    let one = |sample: &control::Sample| ([f64::from(sample.value), 0.0, 0.0], sample.age_ticks);
    let three = |triple: &control::Triple| (triple.value.map(f64::from), triple.age_ticks);
    match sensor {
        Sensor::Gyro => three(&frame.gyro_rad_s),
        Sensor::Accel => three(&frame.accel_m_s2),
        Sensor::Steer => one(&frame.steer_rad),
        Sensor::SteerRate => one(&frame.steer_rate_rad_s),
        Sensor::FrontWheel => one(&frame.front_wheel_m_s),
        Sensor::RearWheel => one(&frame.rear_wheel_m_s),
        Sensor::RiderTorque => one(&frame.rider_torque_nm),
        Sensor::MotorReport => one(&frame.motor_torque_nm),
        Sensor::Path => one(&frame.heading_error_rad),
    }
}
