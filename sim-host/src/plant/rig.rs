//! All sensors, the switch and the clock of one ride, with their faults.

use super::fault::{Channel, Fault, FaultState};
use super::sensor::SensorState;
use super::{Dice, Plant, Reading, Sensor};
use crate::ride::Start;

/// A sensor's newest sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// By [`Sensor::axes`].
    pub value: [f64; 3],
    /// Control periods since it arrived; `u16::MAX` and more count as none.
    pub age_ticks: u16,
}

/// What the controller is told at one control instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    held: [Held; Sensor::ALL.len()],
    /// The controller's time \[us\], wrapping.
    pub now_us: u32,
    /// The rider's switch.
    pub engage: bool,
}

impl Measured {
    /// The newest sample of a sensor.
    pub fn of(&self, sensor: Sensor) -> &Held {
        &self.held[sensor as usize]
    }
}

/// The sensors of one ride.
#[derive(Debug)]
pub struct Rig {
    period_s: f64,
    sensors: Vec<SensorState>,
    faults: Vec<FaultState>,
    held: [Held; Sensor::ALL.len()],
}

impl Rig {
    /// Before the control instant `tick` of the ride from `start`; until then the truth was `steady`.
    /// Tick 0 is at t = 0.
    pub fn new(plant: &Plant, period_s: f64, start: &Start, tick: i64, steady: &Reading) -> Self {
        let config = &plant.sensors;
        let dice = |purpose: usize| Dice::new(plant.seed, start, purpose as u64);
        let sensors = Sensor::ALL
            .map(|s| SensorState::new(config.model(s), plant.truth(s, steady), tick, dice(s as usize)));
        let held = Sensor::ALL.map(|sensor| {
            let model = config.model(sensor);
            // The last sample that arrived before `tick`.
            let since = (tick - 1 - i64::from(model.delay_ticks)).rem_euclid(i64::from(model.every_ticks));
            Held { value: plant.truth(sensor, steady), age_ticks: since as u16 }
        });
        let fault = |(index, fault): (usize, &Fault)| {
            let before = match fault.channel {
                Channel::Sensor(sensor) => plant.truth(sensor, steady),
                Channel::Engage => [1.0, 0.0, 0.0],
                Channel::Motor | Channel::Clock => [0.0; 3],
            };
            FaultState::new(fault, period_s, before, dice(Sensor::ALL.len() + index))
        };
        let faults = plant.faults.iter().enumerate().map(fault).collect();
        Self { period_s, sensors: sensors.into(), faults, held }
    }

    /// What the controller is told at `tick`, one after the last, where the truth is `now` and the
    /// rider's switch stands at `engage`.
    pub fn measure(&mut self, plant: &Plant, tick: i64, now: &Reading, engage: bool) -> Measured {
        for (sensor, state) in Sensor::ALL.into_iter().zip(&mut self.sensors) {
            let arrived = state.arriving(plant.sensors.model(sensor), tick, plant.truth(sensor, now));
            let held = &mut self.held[sensor as usize];
            *held = match faulty(&plant.faults, &mut self.faults, Channel::Sensor(sensor), tick, arrived) {
                Some(value) => Held { value, age_ticks: 0 },
                None => Held { age_ticks: held.age_ticks.saturating_add(1), ..*held },
            };
        }
        let time_s = tick as f64 * self.period_s;
        let mut through = |channel, value: f64| {
            let said = Some([value, 0.0, 0.0]);
            faulty(&plant.faults, &mut self.faults, channel, tick, said).map_or(0.0, |[value, ..]| value)
        };
        let time_s = through(Channel::Clock, time_s);
        let engage = through(Channel::Engage, f64::from(u8::from(engage))) >= 0.5;
        let now_us = (time_s * 1e6).round() as i64 as u32;
        Measured { held: self.held, now_us, engage }
    }

    /// The torque command as it reaches the motor \[N m\].
    pub fn command(&mut self, plant: &Plant, tick: i64, torque_nm: f64) -> f64 {
        let said = Some([torque_nm, 0.0, 0.0]);
        faulty(&plant.faults, &mut self.faults, Channel::Motor, tick, said).map_or(0.0, |[torque, ..]| torque)
    }
}

/// A channel's word through all its faults, in the order in which they were given.
fn faulty(
    faults: &[Fault],
    states: &mut [FaultState],
    channel: Channel,
    tick: i64,
    said: Option<[f64; 3]>,
) -> Option<[f64; 3]> {
    let of_channel = faults.iter().zip(states).filter(|(fault, _)| fault.channel == channel);
    of_channel.fold(said, |said, (fault, state)| state.apply(fault, tick, said))
}
