//! Synthetic perturbation records: a rider on a treadmill at constant speed is pushed sideways at random times, and
//! sensors log the motion. They are the input of a rider identification whose answer is known.
//!
//! The experiment is that of Moore (Human Control of a Bicycle, 2012, section "Lateral Perturbation Force"), whose data
//! Schwab et al. (Rider control identification in bicycling using lateral force perturbation tests, 2013) used: a force on
//! the rear frame beneath the saddle, pulses to both sides that the rider cannot predict.

mod error;
mod noise;
mod pulses;
mod record;

pub use error::PerturbationError;
pub use noise::{Drift, Remnant, SensorNoise};
pub use pulses::Pulses;
pub use record::{Record, RecordSample, SPEED_HOLD_S, nearest_steps, record};

use crate::bicycle::ForcePoint;
use crate::range::within;

/// An experiment with a rider under lateral perturbations.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Experiment {
    /// Forward speed \[m/s\].
    pub speed_m_s: f64,
    /// Duration \[s\].
    pub duration_s: f64,
    /// Samples per second \[Hz\].
    pub rate_hz: f64,
    /// Where the lateral force acts.
    pub point: ForcePoint,
    /// Lateral force \[N\].
    pub force: Pulses,
    /// Steer torque beside the rider's \[N m\]; an amplitude of 0 for none.
    pub steer_torque: Pulses,
    /// Noise of the rider's torque.
    pub remnant: Remnant,
    /// Noise of the sensors.
    pub noise: SensorNoise,
    /// Slow changes of the treadmill and of the steer sensor.
    pub drift: Drift,
    /// Seed of the pulses and of all noise.
    pub seed: u64,
}

impl Experiment {
    /// 60 s at 200 Hz; 40 N for 0.25 s every 5 s on average, at [`ForcePoint::SADDLE`]; nothing else that is random.
    pub fn at(speed_m_s: f64) -> Self {
        Self {
            speed_m_s,
            duration_s: 60.0,
            rate_hz: 200.0,
            point: ForcePoint::SADDLE,
            force: Pulses { amplitude: 40.0, duration_s: 0.25, interval_s: 5.0 },
            steer_torque: Pulses { amplitude: 0.0, duration_s: 0.25, interval_s: 5.0 },
            remnant: Remnant::default(),
            noise: SensorNoise::default(),
            drift: Drift::default(),
            seed: 0,
        }
    }

    /// Time from one sample to the next \[s\].
    pub fn sample_s(&self) -> f64 {
        1.0 / self.rate_hz
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        (self.duration_s * self.rate_hz).round() as usize
    }

    /// Checks ranges.
    ///
    /// # Errors
    /// The value and its range.
    pub fn check(&self) -> Result<(), PerturbationError> {
        within("speed (m/s)", self.speed_m_s, 0.1, 30.0)?;
        within("sample rate (Hz)", self.rate_hz, 10.0, 1000.0)?;
        within("duration (s)", self.duration_s, 1.0, 3600.0)?;
        within("force: ahead of the rear contact (m)", self.point.ahead_m, -3.0, 5.0)?;
        within("force: height above the ground (m)", self.point.height_m, 0.0, 5.0)?;
        self.force.check("lateral force (N)", 2000.0)?;
        self.steer_torque.check("steer torque (N m)", 100.0)?;
        self.remnant.check()?;
        self.noise.check()?;
        self.drift.check()
    }
}
