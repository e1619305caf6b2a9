//! Which sensors may be believed, decided before any arithmetic; and between which bounds the speed is.

use crate::fault::{Cause, Causes};
use crate::maths::{max, min};
use crate::param::{ParamError, ParamSpec, ParamVisitor};
use crate::sensors::calibration::CalibrationPlan;
use crate::sensors::frame::{MISSING, SensorFrame, Wheel};
use crate::sensors::monitor::{CheckedSample, Codes, Loss, Sensor, SensorMonitor, SensorPlan};
use core::hint::cold_path;

/// The declared sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValidationConfig {
    /// Which wheel schedules the gains while both are believed.
    pub wheel: Wheel,
    /// How many of the newest samples the speed's bounds span, 1..=[`RECENT`].
    pub recent_samples: u16,
    /// How fast the speed may change while no sample comes \[m/s^2\]: the bounds widen by it.
    pub drift_m_s2: f32,
    /// Age from which they widen: the time between samples of a good wheel sensor \[control periods\].
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
    /// The drive's torque \[N m\].
    pub motor: Sensor,
    /// The path's errors \[rad, m\].
    pub path: Sensor,
}

/// What is left of `input.wheel` without front wheel and steer angle: the rear wheel.
const REAR: ParamSpec = ParamSpec::new("input", "wheel", 1.0, 1.0);

/// Most samples that the speed's bounds can span.
pub const RECENT: usize = 6;

impl Default for ValidationConfig {
    /// A gyro up to 60 rad/s and a front wheel up to 100 m/s, only fresh samples; nothing else.
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
    /// The same with the gains scheduled by `wheel`; if only the other wheel has a sensor, it moves.
    pub fn scheduled_by(mut self, wheel: Wheel) -> Self {
        let (front, rear) = (self.front_wheel.fitted, self.rear_wheel.fitted);
        if self.wheel != wheel && front != rear {
            core::mem::swap(&mut self.front_wheel, &mut self.rear_wheel);
        }
        Self { wheel, ..self }
    }

    /// Checks that the speed of the wheel that schedules can be known: without a front wheel it takes the steer angle. The
    /// rear wheel is never the faster one, so that the front wheel's speed bounds it.
    ///
    /// # Errors
    /// `input.wheel`, and which value the fitted sensors leave it.
    pub fn cross(&self) -> Result<(), ParamError> {
        let carried = self.front_wheel.fitted || self.steer.fitted || !self.rear_wheel.fitted;
        if self.wheel == Wheel::Front && !carried { Err(REAR.error(0.0)) } else { Ok(()) }
    }

    /// Shows every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        let g = "input";
        let mut wheel = u8::from(self.wheel == Wheel::Rear);
        to.choice(&ParamSpec::new(g, "wheel", 0.0, 1.0), &["front", "rear"], &mut wheel);
        self.wheel = if wheel == 0 { Wheel::Front } else { Wheel::Rear };
        to.count(&ParamSpec::new(g, "recent_samples", 1.0, RECENT as f32), &mut self.recent_samples);
        to.number(&ParamSpec::new(g, "drift_m_s2", 0.0, 100.0), &mut self.drift_m_s2);
        to.count(&ParamSpec::new(g, "drift_after_ticks", 0.0, 10_000.0), &mut self.drift_after_ticks);
        to.optional_number(&ParamSpec::new(g, "max_gap_ms", 0.1, 1000.0), &mut self.max_gap_ms);
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

    /// Each sensor with its codes.
    fn declared(&self) -> [(&Sensor, &'static Codes); 9] {
        [
            (&self.gyro, &GYRO),
            (&self.accel, &ACCEL),
            (&self.steer, &STEER),
            (&self.steer_rate, &STEER_RATE),
            (&self.front_wheel, &FRONT_WHEEL),
            (&self.rear_wheel, &REAR_WHEEL),
            (&self.rider_torque, &RIDER_TORQUE),
            (&self.motor, &MOTOR),
            (&self.path, &PATH),
        ]
    }

    /// Most good samples that any fitted sensor needs before it is believed.
    pub fn slowest_to_qualify(&self) -> u32 {
        let needs =
            |(sensor, _): (&Sensor, _)| if sensor.fitted { u32::from(sensor.qualify_samples) } else { 0 };
        self.declared().into_iter().map(needs).fold(0, u32::max)
    }

    /// The causes that mean `loss`, by the sensors' declarations.
    pub fn causes_of(&self, loss: Loss) -> Causes {
        let mut set = Causes::NONE;
        for (sensor, codes) in self.declared() {
            if sensor.loss == loss {
                set = set.with(codes.set());
            }
        }
        set
    }
}

/// What follows from the declarations and the rate of calls alone.
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
    /// How many samples before the newest the speed's bounds span.
    before: usize,
    /// How much the speed may change in a control period without a sample \[m/s\].
    drift_m_s: f32,
}

impl ValidationPlan {
    /// For one call every `period_s`.
    pub fn new(config: &ValidationConfig, period_s: f32) -> Self {
        let plan = |sensor, codes| SensorPlan::new(sensor, codes, period_s);
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
            before: usize::from(config.recent_samples).saturating_sub(1),
            drift_m_s: config.drift_m_s2 * period_s,
        }
    }
}

macro_rules! codes {
    ($name:ident, $lost:ident, $range:ident, $jump:ident, $stuck:ident) => {
        const $name: Codes =
            Codes { lost: Cause::$lost, range: Cause::$range, jump: Cause::$jump, stuck: Cause::$stuck };
    };
}

codes!(GYRO, GyroLost, GyroRange, GyroJump, GyroStuck);
codes!(ACCEL, AccelLost, AccelRange, AccelJump, AccelStuck);
codes!(STEER, SteerLost, SteerRange, SteerJump, SteerStuck);
codes!(STEER_RATE, SteerRateLost, SteerRateRange, SteerRateJump, SteerRateStuck);
codes!(FRONT_WHEEL, FrontWheelLost, FrontWheelRange, FrontWheelJump, FrontWheelStuck);
codes!(REAR_WHEEL, RearWheelLost, RearWheelRange, RearWheelJump, RearWheelStuck);
codes!(RIDER_TORQUE, RiderTorqueLost, RiderTorqueRange, RiderTorqueJump, RiderTorqueStuck);
codes!(MOTOR, MotorLost, MotorRange, MotorJump, MotorStuck);
codes!(PATH, PathLost, PathLost, PathLost, PathLost);

/// A value known only to lie between two.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpeedInterval {
    /// The least it can be.
    pub low: f32,
    /// The newest sample.
    pub newest: f32,
    /// The most it can be.
    pub high: f32,
}

impl SpeedInterval {
    /// All three times a positive factor.
    pub fn scaled(self, by: f32) -> Self {
        Self { low: self.low * by, newest: self.newest * by, high: self.high * by }
    }

    /// As wide as both together, about this one's newest sample.
    pub fn spanning(self, other: Self) -> Self {
        let low = if other.low < self.low { other.low } else { self.low };
        let high = if other.high > self.high { other.high } else { self.high };
        Self { low, newest: self.newest, high }
    }
}

/// The sensors' values, where a sensor is fitted and believed.
///
/// Which are known stands in bits: one register through the whole control period, where nine options would take nine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measurements {
    known: u16,
    // Zero where nothing is known.
    gyro_rad_s: [f32; 3],
    accel_m_s2: [f32; 3],
    steer_rad: f32,
    steer_rate_rad_s: f32,
    front_wheel_m_s: SpeedInterval,
    rear_wheel_m_s: SpeedInterval,
    rider_torque_nm: f32,
    motor_torque_nm: f32,
    path: [f32; 2],
    /// What is wrong with the others.
    pub causes: Causes,
}

/// The bits of [`Measurements::known`].
const GYRO_KNOWN: u16 = 1;
const ACCEL_KNOWN: u16 = 1 << 1;
const STEER_KNOWN: u16 = 1 << 2;
const STEER_RATE_KNOWN: u16 = 1 << 3;
const FRONT_WHEEL_KNOWN: u16 = 1 << 4;
const REAR_WHEEL_KNOWN: u16 = 1 << 5;
const RIDER_TORQUE_KNOWN: u16 = 1 << 6;
const MOTOR_KNOWN: u16 = 1 << 7;
const PATH_KNOWN: u16 = 1 << 8;

impl Measurements {
    /// What a sensor's watch says: its value and age, if it is known; what is wrong goes to the causes.
    #[inline(always)]
    fn note<const N: usize>(&mut self, sensor: u16, checked: CheckedSample<N>) -> Option<([f32; N], u16)> {
        if let Some(cause) = checked.lost {
            self.causes.note(cause, true);
        }
        if checked.value.is_some() {
            self.known |= sensor;
        }
        checked.value
    }

    fn has(&self, sensor: u16) -> bool {
        self.known & sensor != 0
    }

    /// Angular velocity of the frame \[rad/s\].
    pub fn gyro_rad_s(&self) -> Option<[f32; 3]> {
        self.has(GYRO_KNOWN).then_some(self.gyro_rad_s)
    }

    /// Angular velocity of the frame \[rad/s\], zero if it is not known.
    pub fn gyro_or_zero_rad_s(&self) -> [f32; 3] {
        self.gyro_rad_s
    }

    /// Specific force \[m/s^2\].
    pub fn accel_m_s2(&self) -> Option<[f32; 3]> {
        self.has(ACCEL_KNOWN).then_some(self.accel_m_s2)
    }

    /// Steer angle \[rad\].
    pub fn steer_rad(&self) -> Option<f32> {
        self.has(STEER_KNOWN).then_some(self.steer_rad)
    }

    /// Steer rate \[rad/s\].
    pub fn steer_rate_rad_s(&self) -> Option<f32> {
        self.has(STEER_RATE_KNOWN).then_some(self.steer_rate_rad_s)
    }

    /// Speed of the front wheel \[m/s\].
    pub fn front_wheel_m_s(&self) -> Option<SpeedInterval> {
        self.has(FRONT_WHEEL_KNOWN).then_some(self.front_wheel_m_s)
    }

    /// Speed of the rear wheel \[m/s\].
    pub fn rear_wheel_m_s(&self) -> Option<SpeedInterval> {
        self.has(REAR_WHEEL_KNOWN).then_some(self.rear_wheel_m_s)
    }

    /// The rider's torque \[N m\].
    pub fn rider_torque_nm(&self) -> Option<f32> {
        self.has(RIDER_TORQUE_KNOWN).then_some(self.rider_torque_nm)
    }

    /// The drive's torque \[N m\].
    pub fn motor_torque_nm(&self) -> Option<f32> {
        self.has(MOTOR_KNOWN).then_some(self.motor_torque_nm)
    }

    /// Heading \[rad\] and lateral \[m\] error.
    pub fn path(&self) -> Option<[f32; 2]> {
        self.has(PATH_KNOWN).then_some(self.path)
    }
}

/// What is remembered of the sensors.
#[derive(Clone, Debug, Default)]
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
    /// The frame before.
    before: Before,
}

impl ValidationState {
    /// The sensors of these causes, found by comparison, are not believed any more until they qualify anew.
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

/// What tells whether the bicycle moves; NaN is not known.
#[derive(Clone, Copy, Debug)]
struct Before {
    steer_rad: f32,
    front_wheel_m_s: f32,
    rear_wheel_m_s: f32,
    torque_nm: f32,
}

impl Default for Before {
    fn default() -> Self {
        let unknown = f32::NAN;
        Self { steer_rad: unknown, front_wheel_m_s: unknown, rear_wheel_m_s: unknown, torque_nm: unknown }
    }
}

/// One control period, from a frame as told and the torque commanded last in the bicycle's sign \[N m\]; what comes out is
/// in the bicycle's axes, zeros and signs.
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
    let was = &s.before;
    // What other sensors say of it; NaN says nothing.
    let turned = || (steer_rad - was.steer_rad).abs() > TURNED_RAD;
    let turns = || steer_rate_rad_s.abs() > TURNING_RAD_S;
    let turning = || turned() || turns();
    let swinging = || gyro_rad_s.iter().any(|rate| rate.abs() > SWINGING_RAD_S);
    let front_changes = || (front_m_s - was.front_wheel_m_s).abs() > 0.0;
    let rear_changes = || (rear_m_s - was.rear_wheel_m_s).abs() > 0.0;
    let torque_changes = || (torque_nm - was.torque_nm).abs() > TORQUE_CHANGE_NM;

    let mut b = Measurements::default();
    let sample = (gyro_rad_s, frame.gyro_rad_s.age_ticks);
    let checked = s.gyro.step(&plan.gyro, sample, turning);
    if let Some((value, _)) = b.note(GYRO_KNOWN, checked) {
        b.gyro_rad_s = value;
    }
    let sample = (calibration.accel(&frame.accel_m_s2), frame.accel_m_s2.age_ticks);
    let checked = s.accel.step(&plan.accel, sample, swinging);
    if let Some((value, _)) = b.note(ACCEL_KNOWN, checked) {
        b.accel_m_s2 = value;
    }
    let sample = ([steer_rad], frame.steer_rad.age_ticks);
    let checked = s.steer.step(&plan.steer, sample, turns);
    if let Some(([value], _)) = b.note(STEER_KNOWN, checked) {
        b.steer_rad = value;
    }
    let sample = ([steer_rate_rad_s], frame.steer_rate_rad_s.age_ticks);
    let checked = s.steer_rate.step(&plan.steer_rate, sample, turned);
    if let Some(([value], _)) = b.note(STEER_RATE_KNOWN, checked) {
        b.steer_rate_rad_s = value;
    }
    let sample = ([front_m_s], frame.front_wheel_m_s.age_ticks);
    let checked = s.front_wheel.step(&plan.front_wheel, sample, rear_changes);
    let front = b.note(FRONT_WHEEL_KNOWN, checked);
    b.front_wheel_m_s = s.front_recent.bounds(config, plan, front).unwrap_or_default();
    let sample = ([rear_m_s], frame.rear_wheel_m_s.age_ticks);
    let checked = s.rear_wheel.step(&plan.rear_wheel, sample, front_changes);
    let rear = b.note(REAR_WHEEL_KNOWN, checked);
    b.rear_wheel_m_s = s.rear_recent.bounds(config, plan, rear).unwrap_or_default();
    let sample = ([calibration.rider_torque(&frame.rider_torque_nm)], frame.rider_torque_nm.age_ticks);
    let checked = s.rider_torque.step(&plan.rider_torque, sample, turning);
    if let Some(([value], _)) = b.note(RIDER_TORQUE_KNOWN, checked) {
        b.rider_torque_nm = value;
    }
    let sample = ([calibration.motor_report(&frame.motor_torque_nm)], frame.motor_torque_nm.age_ticks);
    let checked = s.motor.step(&plan.motor, sample, torque_changes);
    if let Some(([value], _)) = b.note(MOTOR_KNOWN, checked) {
        b.motor_torque_nm = value;
    }
    let values = [frame.heading_error_rad.value, frame.lateral_error_m.value];
    let age = frame.heading_error_rad.age_ticks.max(frame.lateral_error_m.age_ticks);
    let checked = s.path.step(&plan.path, (values, age), || false);
    if let Some((value, _)) = b.note(PATH_KNOWN, checked) {
        b.path = value;
    }
    s.before = Before { steer_rad, front_wheel_m_s: front_m_s, rear_wheel_m_s: rear_m_s, torque_nm };
    b
}

/// Steer in one period that counts as turning \[rad\]: 1 rad/s at 1 kHz.
const TURNED_RAD: f32 = 1e-3;
/// Steer rate that counts as turning \[rad/s\].
const TURNING_RAD_S: f32 = 1.0;
/// Angular velocity of the frame that counts as moving \[rad/s\].
const SWINGING_RAD_S: f32 = 0.5;
/// Change of torque in one period that the drive must show \[N m\].
const TORQUE_CHANGE_NM: f32 = 0.01;

/// The newest samples of a wheel.
#[derive(Clone, Copy, Debug)]
struct Recent {
    /// Those before the newest, in a ring, NaN where there was none; `next` is the place of the one to come.
    samples: [f32; RECENT - 1],
    next: usize,
    /// Between which they and the newest are.
    low: f32,
    high: f32,
    /// The age at which the newest sample is still the one of the period before.
    held: u16,
}

impl Default for Recent {
    fn default() -> Self {
        Self { samples: [f32::NAN; RECENT - 1], next: 0, low: 0.0, high: 0.0, held: MISSING }
    }
}

impl Recent {
    /// The bounds of a speed from its newest sample and age, and the samples before it.
    fn bounds(
        &mut self,
        config: &ValidationConfig,
        plan: &ValidationPlan,
        newest: Option<([f32; 1], u16)>,
    ) -> Option<SpeedInterval> {
        let Some(([newest], age)) = newest else {
            *self = Self::default();
            return None;
        };
        if age != self.held {
            self.take(plan.before, newest);
        }
        self.held = age.saturating_add(1);
        let (mut low, mut high) = (self.low, self.high);
        if age > config.drift_after_ticks {
            cold_path();
            let late = f32::from(age - config.drift_after_ticks);
            let drift = plan.drift_m_s * late;
            (low, high) = (low - drift, high + drift);
        }
        Some(SpeedInterval { low, newest, high })
    }

    /// A new sample, with so many before it that count.
    fn take(&mut self, before: usize, newest: f32) {
        let (mut low, mut high) = (newest, newest);
        for sample in self.samples.iter().take(before) {
            (low, high) = (min(*sample, low), max(*sample, high));
        }
        (self.low, self.high) = (low, high);
        if let Some(place) = self.samples.get_mut(self.next) {
            *place = newest;
        }
        self.next = if self.next + 1 < before { self.next + 1 } else { 0 };
    }
}
