//! Estimates steer angle and rate from an encoder, a rate sensor, or both.

use crate::maths::bounded;

/// Limits of the steer angle \[rad\] and rate \[rad/s\].
const MAX: (f32, f32) = (core::f32::consts::PI, 100.0);

/// Minimum lag with a rate sensor \[s\]: the angle then corrects slow errors only.
const FUSED_S: f32 = 0.2;

/// A second-order tracking filter with a double root. The angle follows the encoder. The rate is the rate sensor's plus
/// a correction from the encoder; without a rate sensor the correction is the whole rate, `lag` seconds late. Backward
/// Euler: stable at any sampling rate.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub(super) struct Steer {
    angle_rad: f32,
    /// Correction of the rate sensor \[rad/s\].
    correction_rad_s: f32,
    tracking: bool,
}

impl Steer {
    /// Angle \[rad\] and rate \[rad/s\] after `dt` seconds; both are 0 without any sensor.
    pub(super) fn step(&mut self, lag_s: f32, dt: f32, angle: Option<f32>, rate: Option<f32>) -> (f32, f32) {
        let measured = bounded(rate.unwrap_or(0.0), MAX.1);
        let Some(angle) = angle.map(|a| bounded(a, MAX.0)) else {
            *self = Self::default();
            return (0.0, measured);
        };
        if !self.tracking {
            *self = Self { angle_rad: angle, correction_rad_s: 0.0, tracking: true };
        }
        let lag_s = if rate.is_some() && lag_s < FUSED_S { FUSED_S } else { lag_s };
        let w = 2.0 * dt / lag_s;
        let factor = 1.0 / ((1.0 + w) * (1.0 + w));
        let predicted = self.angle_rad + dt * (measured + self.correction_rad_s);
        let error = angle - predicted;
        self.angle_rad = bounded(predicted + error * (w * (2.0 + w) * factor), MAX.0);
        self.correction_rad_s = bounded(self.correction_rad_s + error * (w * factor) * (2.0 / lag_s), MAX.1);
        (self.angle_rad, measured + self.correction_rad_s)
    }
}
