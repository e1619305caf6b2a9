//! The simulated record.

use super::noise::low_passed;
use super::{Drift, Experiment, PerturbationError};
use crate::num::RandomStream;
use crate::ride::{Assist, Conditions, FallCause, Perturbed, Push, perturbed};
use serde::Serialize;

/// Time constant with which the rider holds the belt's speed by pedalling \[s\].
pub const SPEED_HOLD_S: f64 = 1.0;

/// Longest and shortest time step of the integration \[s\].
const STEPS_S: [f64; 2] = [2.5e-4, 1e-5];

/// One line of a record. Right positive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RecordSample {
    /// Time \[s\].
    pub time_s: f64,
    /// Lateral force from this sample to the next \[N\].
    pub lateral_force_n: f64,
    /// Disturbing steer torque from this sample to the next \[N m\], without the rider's; `None` if there is none in the
    /// experiment.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steer_torque_nm: Option<f64>,
    /// Measured steer angle \[rad\].
    pub steer_rad: f64,
    /// Measured roll angle \[rad\].
    pub roll_rad: f64,
    /// Measured roll rate \[rad/s\].
    pub roll_rate_rad_s: f64,
    /// Forward speed \[m/s\].
    pub speed_m_s: f64,
}

/// A perturbation record.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Its samples, up to a fall.
    pub samples: Vec<RecordSample>,
    /// Time \[s\] and cause of a fall.
    pub fall: Option<(f64, FallCause)>,
}

impl Record {
    /// The record of a ride that did not fall.
    ///
    /// # Errors
    /// The fall.
    pub fn upright(self) -> Result<Self, PerturbationError> {
        match self.fall {
            Some((time_s, cause)) => Err(PerturbationError::Fall { time_s, cause }),
            None => Ok(self),
        }
    }
}

/// What a stream of random numbers is for.
#[derive(Clone, Copy)]
enum Purpose {
    Force,
    SteerTorque,
    Remnant,
    SpeedDrift,
    SteerDrift,
    SteerNoise,
    RollNoise,
    RollRateNoise,
}

/// The random numbers for one purpose: the same for every bicycle, rider and speed, so that a seed stands for one sequence
/// of pulses.
fn stream(experiment: &Experiment, purpose: Purpose) -> RandomStream {
    RandomStream::new(experiment.seed, [0.0; 3], purpose as u64)
}

impl Experiment {
    /// The lateral force from each sample to the next \[N\].
    pub fn lateral_force(&self) -> Vec<f64> {
        self.force.values(stream(self, Purpose::Force), self.sample_s(), self.samples())
    }
}

/// Simulates an experiment. Of the conditions it has the bicycle, the rider, the schedule speed and the fall criterion;
/// there is neither assist nor plant.
///
/// The rider holds the belt's speed by pedalling, with a time constant of 1 s; without that, the speed would follow the
/// energy of pushes and steering. A slow change of the belt's speed is one of the bicycle's on the road.
///
/// # Errors
/// A value is outside its range, or no time step divides the neural delay and the time between samples.
pub fn record(conditions: &Conditions, experiment: &Experiment) -> Result<Record, PerturbationError> {
    experiment.check()?;
    let (n, sample_s) = (experiment.samples(), experiment.sample_s());
    let delay_s = conditions.rider.as_ref().map_or(0.0, |rider| rider.delay_s);
    let (steps_per_sample, step_s) = steps(delay_s, sample_s)?;
    let conditions = Conditions {
        step_s,
        assist: Assist::None,
        sensor_delay_ticks: 0,
        time_limit_s: experiment.duration_s,
        ..conditions.clone()
    };
    conditions.check()?;
    let stream = |purpose: Purpose| stream(experiment, purpose);
    let slow = |purpose, std| low_passed(stream(purpose), std, Drift::TIME_S, sample_s, n);

    let force = experiment.lateral_force();
    let torque = experiment.steer_torque.values(stream(Purpose::SteerTorque), sample_s, n);
    let remnant = experiment.remnant;
    let remnant =
        low_passed(stream(Purpose::Remnant), remnant.std_nm, 1.0 / remnant.corner_rad_s, sample_s, n);
    let faster = slow(Purpose::SpeedDrift, experiment.drift.speed_m_s);
    let pushes: Vec<Push> = (0..n)
        .map(|i| Push {
            lateral_force_n: force[i],
            steer_torque_nm: torque[i] + remnant[i],
            speed_m_s: experiment.speed_m_s + faster[i],
        })
        .collect();
    let how = Perturbed { point: experiment.point, steps_per_sample, speed_hold_s: Some(SPEED_HOLD_S) };
    let ride = perturbed(&conditions, &how, experiment.speed_m_s, &pushes);

    let offset = slow(Purpose::SteerDrift, experiment.drift.steer_rad);
    let [mut steer, mut roll, mut roll_rate] =
        [Purpose::SteerNoise, Purpose::RollNoise, Purpose::RollRateNoise].map(stream);
    let noise = experiment.noise;
    let samples = ride.samples.iter().enumerate().map(|(i, motion)| RecordSample {
        time_s: i as f64 / experiment.rate_hz,
        lateral_force_n: force[i],
        steer_torque_nm: (experiment.steer_torque.amplitude > 0.0).then_some(torque[i]),
        steer_rad: motion.steer_rad + offset[i] + noise.steer_rad * steer.normal(),
        roll_rad: motion.roll_rad + noise.roll_rad * roll.normal(),
        roll_rate_rad_s: motion.roll_rate_rad_s + noise.roll_rate_rad_s * roll_rate.normal(),
        speed_m_s: motion.speed_m_s,
    });
    Ok(Record { samples: samples.collect(), fall: ride.fall })
}

/// Steps among which [`nearest_steps`] chooses, in multiples of the fewest.
const CHOICE: u32 = 10;
/// Rounding of the delay that counts as none, in steps.
const WHOLE: f64 = 1e-6;

/// The fewest time steps per sample that are not too long.
fn fewest(sample_s: f64) -> u32 {
    (sample_s / STEPS_S[0] - 1e-6).ceil().max(1.0) as u32
}

/// Difference of the delay from whole steps, in steps.
fn rounding(delay_s: f64, sample_s: f64, steps: u32) -> f64 {
    let delay = delay_s / sample_s * f64::from(steps);
    (delay - delay.round()).abs()
}

/// The fewest time steps per sample of which the delay is a multiple, too; otherwise those that round it least: their number
/// and their length \[s\].
pub fn nearest_steps(delay_s: f64, sample_s: f64) -> (u32, f64) {
    let all = || fewest(sample_s)..=CHOICE * fewest(sample_s);
    let whole = all().find(|steps| rounding(delay_s, sample_s, *steps) < WHOLE);
    let rounding_s = |steps: &u32| rounding(delay_s, sample_s, *steps) / f64::from(*steps);
    let nearest = || all().min_by(|a, b| rounding_s(a).total_cmp(&rounding_s(b)));
    let steps = whole.or_else(nearest).unwrap_or(fewest(sample_s));
    (steps, sample_s / f64::from(steps))
}

/// The fewest time steps per sample of which the delay is a multiple, too, and their length \[s\].
fn steps(delay_s: f64, sample_s: f64) -> Result<(u32, f64), PerturbationError> {
    let most = (sample_s / STEPS_S[1] + 1e-6).floor() as u32;
    let steps = (fewest(sample_s)..=most).find(|steps| rounding(delay_s, sample_s, *steps) < WHOLE);
    let steps = steps.ok_or(PerturbationError::Step { delay_s, sample_s })?;
    Ok((steps, sample_s / f64::from(steps)))
}
