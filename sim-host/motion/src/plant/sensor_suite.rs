//! All sensors, the switch and the clock of one ride, with their faults.

use super::fault::{Channel, Fault, FaultState};
use super::sensor::{Before, SensorRng, SensorState};
use super::{Plant, Reading, Sensor};
use crate::bicycle::Start;
use crate::num::RandomStream;

/// First random-number purpose of fitted errors, beyond those of sensors and faults.
const FITTED: usize = 1 << 32;

/// A sensor's newest sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// Values in the order of [`Sensor::axes`].
    pub value: [f64; 3],
    /// Control periods since it arrived; `u16::MAX` counts as no sample.
    pub age_ticks: u16,
}

/// Inputs of the controller at one control instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    held: [Held; Sensor::ALL.len()],
    /// The controller's time \[us\], wrapping.
    pub now_us: u32,
    /// The rider's switch.
    pub engage: bool,
}

impl Measured {
    /// From the newest sample of each sensor, in the order of [`Sensor::ALL`].
    pub fn new(held: [Held; Sensor::ALL.len()], now_us: u32, engage: bool) -> Self {
        Self { held, now_us, engage }
    }

    /// The newest sample of a sensor.
    pub fn of(&self, sensor: Sensor) -> &Held {
        &self.held[sensor as usize]
    }
}

/// Sensors of one ride, from the controller's boot.
#[derive(Debug)]
pub struct SensorSuite {
    period_s: f64,
    sensors: Vec<SensorState>,
    faults: Vec<FaultState>,
    held: [Held; Sensor::ALL.len()],
    /// Current control instant, counted from boot; -1 before.
    tick: i64,
    /// Control instant of t = 0, once it is known.
    zero: Option<i64>,
    /// The last torque command that reached the motor \[N m\].
    command_nm: f64,
}

impl SensorSuite {
    /// State at boot, before a ride from `start`; until then the true values were `steady`.
    pub fn new(plant: &Plant, period_s: f64, start: &Start, steady: &Reading) -> Self {
        let config = &plant.sensors;
        let random = |purpose: usize| RandomStream::new(plant.seed, start.key(), purpose as u64);
        let state = |s: Sensor| {
            let truth = plant.truth(s, steady);
            let before = Before { truth, speed_m_s: steady.rear_wheel_m_s, period_s };
            let random = SensorRng { plain: random(s as usize), fitted: random(FITTED + s as usize) };
            SensorState::new(config.model(s), &before, random)
        };
        let held = |sensor: Sensor| Held {
            value: plant.truth(sensor, steady),
            age_ticks: config.model(sensor).age_before_boot(),
        };
        let fault = |(index, fault): (usize, &Fault)| {
            let before = match fault.channel {
                Channel::Sensor(sensor) => plant.truth(sensor, steady),
                Channel::Motor | Channel::Engage | Channel::Clock => [0.0; 3],
            };
            FaultState::new(fault, period_s, before, random(Sensor::ALL.len() + index))
        };
        Self {
            period_s,
            sensors: Sensor::ALL.map(state).into(),
            faults: plant.faults.iter().enumerate().map(fault).collect(),
            held: Sensor::ALL.map(held),
            tick: -1,
            zero: None,
            command_nm: 0.0,
        }
    }

    /// A copy; `None` if anything is random or there are faults, so that rides at one speed differ before t = 0.
    pub fn copied(&self) -> Option<Self> {
        let sensors: Option<Vec<SensorState>> = self.sensors.iter().map(SensorState::copied).collect();
        let sensors = sensors.filter(|_| self.faults.is_empty())?;
        Some(Self { sensors, faults: Vec::new(), ..*self })
    }

    /// Marks the next control instant as t = 0; the times of faults count from there.
    pub fn begin(&mut self) {
        self.zero = Some(self.tick + 1);
    }

    /// Current control instant, counted from t = 0; -1 before.
    fn since_start(&self) -> i64 {
        self.zero.map_or(-1, |zero| self.tick - zero)
    }

    /// Inputs of the controller at the next control instant, from the true values `now` and the state
    /// `engage` of the rider's switch.
    pub fn measure(&mut self, plant: &Plant, now: &Reading, engage: bool) -> Measured {
        self.tick += 1;
        let (tick, ride) = (self.tick, self.since_start());
        for (sensor, state) in Sensor::ALL.into_iter().zip(&mut self.sensors) {
            let (model, truth) = (plant.sensors.model(sensor), plant.truth(sensor, now));
            let arrived = state.arriving(model, tick, truth, now.rear_wheel_m_s);
            let held = &mut self.held[sensor as usize];
            *held = match faulty(&plant.faults, &mut self.faults, Channel::Sensor(sensor), ride, arrived) {
                Some(value) => Held { value, age_ticks: 0 },
                None => Held { age_ticks: held.age_ticks.saturating_add(1), ..*held },
            };
        }
        let mut through = |channel, value: f64| {
            let sample = Some([value, 0.0, 0.0]);
            faulty(&plant.faults, &mut self.faults, channel, ride, sample).map_or(0.0, |[value, ..]| value)
        };
        let time_s = through(Channel::Clock, tick as f64 * self.period_s);
        let engage = through(Channel::Engage, f64::from(u8::from(engage))) >= 0.5;
        let now_us = (time_s * 1e6).round() as i64 as u32;
        Measured { held: self.held, now_us, engage }
    }

    /// The torque command of the current control instant as it reaches the motor \[N m\].
    pub fn command(&mut self, plant: &Plant, torque_nm: f64) -> f64 {
        let (ride, sample) = (self.since_start(), Some([torque_nm, 0.0, 0.0]));
        if let Some([torque_nm, ..]) = faulty(&plant.faults, &mut self.faults, Channel::Motor, ride, sample) {
            self.command_nm = torque_nm;
        }
        self.command_nm
    }
}

/// Applies all faults of a channel to a sample, in the order in which they were given.
pub fn faulty(
    faults: &[Fault],
    states: &mut [FaultState],
    channel: Channel,
    tick: i64,
    sample: Option<[f64; 3]>,
) -> Option<[f64; 3]> {
    let of_channel = faults.iter().zip(states).filter(|(fault, _)| fault.channel == channel);
    of_channel.fold(sample, |sample, (fault, state)| state.apply(fault, tick, sample))
}
