//! Random parts of a record: remnant, sensor noise, drift.

use super::PerturbationError;
use crate::num::RandomStream;
use crate::range::within;

/// Noise of the rider's steer torque: what a rider does that no linear feedback explains (McRuer and Jex 1967). White
/// noise through a first-order low-pass filter, independent of the motion, added to the neuromuscular torque.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Remnant {
    /// Standard deviation \[N m\]; 0 for none.
    pub std_nm: f64,
    /// Corner frequency of the filter \[rad/s\].
    pub corner_rad_s: f64,
}

impl Default for Remnant {
    /// None; if its standard deviation is changed, with the corner frequency of the shoulders' dynamics.
    fn default() -> Self {
        Self { std_nm: 0.0, corner_rad_s: crate::rider::Neuromuscular::SHOULDERS.omega_rad_s }
    }
}

/// Standard deviations of the sensors' white noise; 0 for none.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct SensorNoise {
    /// Of the steer angle \[rad\].
    pub steer_rad: f64,
    /// Of the roll angle \[rad\].
    pub roll_rad: f64,
    /// Of the roll rate \[rad/s\].
    pub roll_rate_rad_s: f64,
}

/// Slow changes, each white noise through a first-order low-pass filter with a time constant of 20 s, beginning at 0. Standard deviations after several time constants; 0 for none.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Drift {
    /// Of the belt's speed, which the bicycle follows \[m/s\].
    pub speed_m_s: f64,
    /// Of the steer sensor's offset \[rad\].
    pub steer_rad: f64,
}

impl Drift {
    /// Time constant of the drift \[s\]: several pulses long, so that it does not look like an answer to one.
    pub const TIME_S: f64 = 20.0;

    pub(super) fn check(&self) -> Result<(), PerturbationError> {
        within("drift of the speed (m/s)", self.speed_m_s, 0.0, 1.0)?;
        Ok(within("drift of the steer sensor (rad)", self.steer_rad, 0.0, 0.5)?)
    }
}

impl Remnant {
    pub(super) fn check(&self) -> Result<(), PerturbationError> {
        within("remnant (N m)", self.std_nm, 0.0, 50.0)?;
        Ok(within("corner frequency of the remnant (rad/s)", self.corner_rad_s, 0.1, 1000.0)?)
    }
}

impl SensorNoise {
    pub(super) fn check(&self) -> Result<(), PerturbationError> {
        within("steer noise (rad)", self.steer_rad, 0.0, 1.0)?;
        within("roll noise (rad)", self.roll_rad, 0.0, 1.0)?;
        Ok(within("roll rate noise (rad/s)", self.roll_rate_rad_s, 0.0, 10.0)?)
    }
}

/// White noise of standard deviation `std` through a first-order low-pass filter of time constant `time_s`, at `n`
/// instants `sample_s` apart: exact at these instants, 0 at the first.
pub(super) fn low_passed(
    mut stream: RandomStream,
    std: f64,
    time_s: f64,
    sample_s: f64,
    n: usize,
) -> Vec<f64> {
    let kept = libm::exp(-sample_s / time_s);
    let fresh = std * (1.0 - kept * kept).sqrt();
    let mut value = 0.0;
    (0..n)
        .map(|_| {
            let now = value;
            value = kept * value + fresh * stream.normal();
            now
        })
        .collect()
}
