//! Validates every sensor of a frame before the measurements are used, and bounds the wheel speeds.

use crate::fault::{Cause, Causes};
use crate::param::{ParamError, ParamSpec, ParamVisitor};
use crate::sensors::calibration::CalibrationPlan;
use crate::sensors::frame::{SensorFrame, Wheel};
use crate::sensors::measurements::{
    ACCEL_VALID, FRONT_WHEEL_VALID, GYRO_VALID, MOTOR_VALID, Measurements, PATH_VALID, REAR_WHEEL_VALID,
    RIDER_TORQUE_VALID, STEER_RATE_VALID, STEER_VALID,
};
use crate::sensors::monitor::{Loss, Sensor, SensorCauses, SensorMonitor, SensorPlan};
use crate::sensors::recent::Recent;

/// Declared sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValidationConfig {
    /// Wheel that schedules the gains while both are valid.
    pub wheel: Wheel,
    /// Number of newest samples that the speed's bounds span, 1..=[`MAX_RECENT_SAMPLES`].
    pub recent_samples: u16,
    /// Largest rate of change of the speed without a new sample \[m/s^2\]; the bounds widen at this rate.
    pub drift_m_s2: f32,
    /// Age above which the bounds widen: the time between samples of a good wheel sensor \[control periods\].
    pub drift_after_ticks: u16,
    /// Longest time between two control periods \[ms\].
    pub max_gap_ms: Option<f32>,
    /// Angular velocity of the frame \[rad/s\].
    pub gyro: Sensor,
    /// Specific force \[m/s^2\].
    pub accel: Sensor,
    /// Steer angle \[rad\].
    pub steer: Sensor,
    /// Steer rate \[rad/s\].
    pub steer_rate: Sensor,
    /// Speed of the front wheel \[m/s\].
    pub front_wheel: Sensor,
    /// Speed of the rear wheel \[m/s\].
    pub rear_wheel: Sensor,
    /// The rider's torque \[N m\].
    pub rider_torque: Sensor,
    /// Torque reported by the drive \[N m\].
    pub motor: Sensor,
    /// Path errors: heading \[rad\] and lateral \[m\].
    pub path: Sensor,
}

/// The only choice of `input.wheel` without front wheel and steer angle: the rear wheel.
const REAR: ParamSpec = ParamSpec::new("input", "wheel", 1.0, 1.0);

/// Longest time between two control periods \[ms\].
const MAX_GAP: ParamSpec = ParamSpec::new("input", "max_gap_ms", 0.1, 1000.0);

/// Largest number of samples that the speed's bounds can span.
pub const MAX_RECENT_SAMPLES: usize = 6;

impl Default for ValidationConfig {
    /// A gyro up to 60 rad/s and a front wheel up to 100 m/s, only fresh samples; no other sensor.
    fn default() -> Self {
        let none = Sensor::default();
        Self {
            wheel: Wheel::Front,
            recent_samples: 1,
            drift_m_s2: 0.0,
            drift_after_ticks: 0,
            max_gap_ms: None,
            gyro: Sensor::exact(60.0),
            accel: none,
            steer: none,
            steer_rate: none,
            front_wheel: Sensor::exact(100.0),
            rear_wheel: none,
            rider_torque: none,
            motor: none,
            path: none,
        }
    }
}

impl ValidationConfig {
    /// The configuration with gains scheduled by `wheel`. If only the other wheel has a sensor, that sensor is moved to
    /// `wheel`.
    pub fn scheduled_by(mut self, wheel: Wheel) -> Self {
        let (front, rear) = (self.front_wheel.fitted, self.rear_wheel.fitted);
        if self.wheel != wheel && front != rear {
            core::mem::swap(&mut self.front_wheel, &mut self.rear_wheel);
        }
        Self { wheel, ..self }
    }

    /// Checks relations to other parameters. The speed of the scheduling wheel can be computed: without a front wheel
    /// sensor that takes the steer angle; the rear wheel is never the faster one, so the front wheel's speed bounds it.
    /// A gap as long as the control period, in the clock's whole microseconds, is none.
    ///
    /// # Errors
    /// `input.wheel` or `input.max_gap_ms`, and the values that the others allow.
    pub fn cross(&self, rate_hz: f32) -> Result<(), ParamError> {
        let speed_available = self.front_wheel.fitted || self.steer.fitted || !self.rear_wheel.fitted;
        if self.wheel == Wheel::Front && !speed_available {
            return Err(REAR.error(0.0));
        }
        let min = longest_period_us(rate_hz) / 1e3;
        self.max_gap_ms.map_or(Ok(()), |ms| ParamSpec { min, ..MAX_GAP }.check(ms))
    }

    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        let g = "input";
        let mut wheel = u8::from(self.wheel == Wheel::Rear);
        to.choice(&ParamSpec::new(g, "wheel", 0.0, 1.0), &["front", "rear"], &mut wheel);
        self.wheel = if wheel == 0 { Wheel::Front } else { Wheel::Rear };
        to.count(
            &ParamSpec::new(g, "recent_samples", 1.0, MAX_RECENT_SAMPLES as f32),
            &mut self.recent_samples,
        );
        to.number(&ParamSpec::new(g, "drift_m_s2", 0.0, 100.0), &mut self.drift_m_s2);
        to.count(&ParamSpec::new(g, "drift_after_ticks", 0.0, 10_000.0), &mut self.drift_after_ticks);
        to.optional_number(&MAX_GAP, &mut self.max_gap_ms);
        self.gyro.visit_params("input.gyro", to);
        self.accel.visit_params("input.accel", to);
        self.steer.visit_params("input.steer", to);
        self.steer_rate.visit_params("input.steer_rate", to);
        self.front_wheel.visit_params("input.front_wheel", to);
        self.rear_wheel.visit_params("input.rear_wheel", to);
        self.rider_torque.visit_params("input.rider_torque", to);
        self.motor.visit_params("input.motor", to);
        self.path.visit_params("input.path", to);
    }

    /// Each sensor with its causes. Every field is named, so a new sensor does not compile without its causes.
    fn declared(&self) -> [(&Sensor, &'static SensorCauses); 9] {
        let Self {
            wheel: _,
            recent_samples: _,
            drift_m_s2: _,
            drift_after_ticks: _,
            max_gap_ms: _,
            gyro,
            accel,
            steer,
            steer_rate,
            front_wheel,
            rear_wheel,
            rider_torque,
            motor,
            path,
        } = self;
        [
            (gyro, &GYRO),
            (accel, &ACCEL),
            (steer, &STEER),
            (steer_rate, &STEER_RATE),
            (front_wheel, &FRONT_WHEEL),
            (rear_wheel, &REAR_WHEEL),
            (rider_torque, &RIDER_TORQUE),
            (motor, &MOTOR),
            (path, &PATH),
        ]
    }

    /// Largest number of good samples that any fitted sensor needs to qualify.
    pub fn slowest_to_qualify(&self) -> u32 {
        let needs =
            |(sensor, _): (&Sensor, _)| if sensor.fitted { u32::from(sensor.qualify_samples) } else { 0 };
        self.declared().into_iter().map(needs).fold(0, u32::max)
    }

    /// The causes that lead to `loss`, by the sensors' declarations.
    pub fn causes_of(&self, loss: Loss) -> Causes {
        let mut set = Causes::NONE;
        for (sensor, causes) in self.declared() {
            if sensor.loss == loss {
                set = set.with(causes.set());
            }
        }
        set
    }
}

/// The longest time between two calls at `rate_hz` on a clock of whole microseconds \[us\].
fn longest_period_us(rate_hz: f32) -> f32 {
    let period_us = 1e6 / rate_hz;
    let whole = period_us as u32 as f32;
    if whole < period_us { whole + 1.0 } else { whole }
}

/// Constants derived from the declarations and the call rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValidationPlan {
    gyro: SensorPlan,
    accel: SensorPlan,
    steer: SensorPlan,
    steer_rate: SensorPlan,
    front_wheel: SensorPlan,
    rear_wheel: SensorPlan,
    rider_torque: SensorPlan,
    motor: SensorPlan,
    path: SensorPlan,
    /// Number of samples before the newest that the speed's bounds span.
    pub(super) earlier_samples: usize,
    /// Largest change of the speed in a control period without a sample \[m/s\].
    pub(super) drift_m_s: f32,
}

impl ValidationPlan {
    /// For one call every `period_s` seconds.
    pub fn new(config: &ValidationConfig, period_s: f32) -> Self {
        let plan = |sensor, causes| SensorPlan::new(sensor, causes, period_s);
        Self {
            gyro: plan(&config.gyro, GYRO),
            accel: plan(&config.accel, ACCEL),
            steer: plan(&config.steer, STEER),
            steer_rate: plan(&config.steer_rate, STEER_RATE),
            front_wheel: plan(&config.front_wheel, FRONT_WHEEL),
            rear_wheel: plan(&config.rear_wheel, REAR_WHEEL),
            rider_torque: plan(&config.rider_torque, RIDER_TORQUE),
            motor: plan(&config.motor, MOTOR),
            path: plan(&config.path, PATH),
            earlier_samples: usize::from(config.recent_samples).saturating_sub(1),
            drift_m_s: config.drift_m_s2 * period_s,
        }
    }
}

macro_rules! sensor_causes {
    ($name:ident, $lost:ident, $range:ident, $jump:ident, $stuck:ident) => {
        const $name: SensorCauses = SensorCauses {
            lost: Cause::$lost,
            range: Cause::$range,
            jump: Cause::$jump,
            stuck: Cause::$stuck,
        };
    };
}

sensor_causes!(GYRO, GyroLost, GyroRange, GyroJump, GyroStuck);
sensor_causes!(ACCEL, AccelLost, AccelRange, AccelJump, AccelStuck);
sensor_causes!(STEER, SteerLost, SteerRange, SteerJump, SteerStuck);
sensor_causes!(STEER_RATE, SteerRateLost, SteerRateRange, SteerRateJump, SteerRateStuck);
sensor_causes!(FRONT_WHEEL, FrontWheelLost, FrontWheelRange, FrontWheelJump, FrontWheelStuck);
sensor_causes!(REAR_WHEEL, RearWheelLost, RearWheelRange, RearWheelJump, RearWheelStuck);
sensor_causes!(RIDER_TORQUE, RiderTorqueLost, RiderTorqueRange, RiderTorqueJump, RiderTorqueStuck);
sensor_causes!(MOTOR, MotorLost, MotorRange, MotorJump, MotorStuck);
sensor_causes!(PATH, PathLost, PathLost, PathLost, PathLost);

/// Monitors of all sensors, and the previous frame.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct ValidationState {
    gyro: SensorMonitor<3>,
    accel: SensorMonitor<3>,
    steer: SensorMonitor<1>,
    steer_rate: SensorMonitor<1>,
    front_wheel: SensorMonitor<1>,
    rear_wheel: SensorMonitor<1>,
    rider_torque: SensorMonitor<1>,
    motor: SensorMonitor<1>,
    path: SensorMonitor<2>,
    front_recent: Recent,
    rear_recent: Recent,
    /// Values of the previous frame.
    previous: Previous,
}

impl ValidationState {
    /// Invalidates the sensors of these causes, found by the cross-checks, until they requalify.
    #[cold]
    pub fn invalidate(&mut self, causes: Causes) {
        if causes.has(Cause::GyroStuck) {
            self.gyro.invalidate(Cause::GyroStuck, true);
        }
        if causes.has(Cause::AccelStuck) {
            self.accel.invalidate(Cause::AccelStuck, true);
        }
        if causes.has(Cause::RearWheelJump) {
            self.rear_wheel.invalidate(Cause::RearWheelJump, false);
        }
    }
}

/// Values of the previous frame whose change shows motion; NaN is unknown.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
struct Previous {
    steer_rad: f32,
    front_wheel_m_s: f32,
    rear_wheel_m_s: f32,
    torque_nm: f32,
}

impl Default for Previous {
    fn default() -> Self {
        let unknown = f32::NAN;
        Self { steer_rad: unknown, front_wheel_m_s: unknown, rear_wheel_m_s: unknown, torque_nm: unknown }
    }
}

/// One control period: validates a frame's samples and converts them to the bicycle's axes, zeros and signs.
/// `torque_nm` is the last commanded torque, in the bicycle's sign \[N m\].
pub fn step(
    config: &ValidationConfig,
    plan: &ValidationPlan,
    calibration: &CalibrationPlan,
    state: &mut ValidationState,
    frame: &SensorFrame,
    torque_nm: f32,
) -> Measurements {
    let s = state;
    let gyro_rad_s = calibration.gyro(&frame.gyro_rad_s);
    let steer_rad = calibration.steer(&frame.steer_rad);
    let steer_rate_rad_s = calibration.steer_rate(&frame.steer_rate_rad_s);
    let [front_m_s, rear_m_s] = [frame.front_wheel_m_s.value, frame.rear_wheel_m_s.value];
    let previous = &s.previous;
    // Motion shown by the other sensors; comparisons with NaN show none.
    let steer_moved = || (steer_rad - previous.steer_rad).abs() > STEER_MOVED_RAD;
    let steer_rate_high = || steer_rate_rad_s.abs() > STEERING_RAD_S;
    let steering = || steer_moved() || steer_rate_high();
    let frame_rotating = || gyro_rad_s.iter().any(|rate| rate.abs() > ROTATING_RAD_S);
    let front_changes = || (front_m_s - previous.front_wheel_m_s).abs() > 0.0;
    let rear_changes = || (rear_m_s - previous.rear_wheel_m_s).abs() > 0.0;
    let torque_changes = || (torque_nm - previous.torque_nm).abs() > TORQUE_CHANGE_NM;

    let mut measurements = Measurements::default();
    let sample = (gyro_rad_s, frame.gyro_rad_s.age_ticks);
    let checked = s.gyro.step(&plan.gyro, sample, steering);
    if let Some((value, _)) = measurements.note(GYRO_VALID, checked) {
        measurements.gyro_rad_s = value;
    }
    let sample = (calibration.accel(&frame.accel_m_s2), frame.accel_m_s2.age_ticks);
    let checked = s.accel.step(&plan.accel, sample, frame_rotating);
    if let Some((value, _)) = measurements.note(ACCEL_VALID, checked) {
        measurements.accel_m_s2 = value;
    }
    let sample = ([steer_rad], frame.steer_rad.age_ticks);
    let checked = s.steer.step(&plan.steer, sample, steer_rate_high);
    if let Some(([value], _)) = measurements.note(STEER_VALID, checked) {
        measurements.steer_rad = value;
    }
    let sample = ([steer_rate_rad_s], frame.steer_rate_rad_s.age_ticks);
    let checked = s.steer_rate.step(&plan.steer_rate, sample, steer_moved);
    if let Some(([value], _)) = measurements.note(STEER_RATE_VALID, checked) {
        measurements.steer_rate_rad_s = value;
    }
    let sample = ([front_m_s], frame.front_wheel_m_s.age_ticks);
    let checked = s.front_wheel.step(&plan.front_wheel, sample, rear_changes);
    let front = measurements.note(FRONT_WHEEL_VALID, checked);
    measurements.front_wheel_m_s = s.front_recent.bounds(config, plan, front).unwrap_or_default();
    let sample = ([rear_m_s], frame.rear_wheel_m_s.age_ticks);
    let checked = s.rear_wheel.step(&plan.rear_wheel, sample, front_changes);
    let rear = measurements.note(REAR_WHEEL_VALID, checked);
    measurements.rear_wheel_m_s = s.rear_recent.bounds(config, plan, rear).unwrap_or_default();
    let sample = ([calibration.rider_torque(&frame.rider_torque_nm)], frame.rider_torque_nm.age_ticks);
    let checked = s.rider_torque.step(&plan.rider_torque, sample, steering);
    if let Some(([value], _)) = measurements.note(RIDER_TORQUE_VALID, checked) {
        measurements.rider_torque_nm = value;
    }
    let sample = ([calibration.motor_report(&frame.motor_torque_nm)], frame.motor_torque_nm.age_ticks);
    let checked = s.motor.step(&plan.motor, sample, torque_changes);
    if let Some(([value], _)) = measurements.note(MOTOR_VALID, checked) {
        measurements.motor_torque_nm = value;
    }
    let values = [frame.heading_error_rad.value, frame.lateral_error_m.value];
    let age = frame.heading_error_rad.age_ticks.max(frame.lateral_error_m.age_ticks);
    let checked = s.path.step(&plan.path, (values, age), || false);
    if let Some((value, _)) = measurements.note(PATH_VALID, checked) {
        measurements.path = value;
    }
    s.previous = Previous { steer_rad, front_wheel_m_s: front_m_s, rear_wheel_m_s: rear_m_s, torque_nm };
    measurements
}

/// Change of the steer angle in one period that counts as turning \[rad\]: 1 rad/s at 1 kHz.
const STEER_MOVED_RAD: f32 = 1e-3;
/// Steer rate that counts as turning \[rad/s\].
const STEERING_RAD_S: f32 = 1.0;
/// Angular velocity of the frame that counts as moving \[rad/s\].
const ROTATING_RAD_S: f32 = 0.5;
/// Change of the commanded torque in one period that the drive's report must follow \[N m\].
const TORQUE_CHANGE_NM: f32 = 0.01;
