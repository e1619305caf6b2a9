//! Steer angle and rate from an encoder, a rate sensor, or both.

use crate::maths::bounded;

/// Largest believed steer angle \[rad\] and rate \[rad/s\].
const MAX: (f32, f32) = (core::f32::consts::PI, 100.0);

/// Least lag while there is a rate sensor \[s\]: the angle then has to show slow errors only.
const FUSED_S: f32 = 0.2;

/// A second-order tracking filter with both roots equal: the angle follows the encoder, the rate is
/// the rate sensor's plus what the encoder shows to be missing in it; without a rate sensor that is
/// the whole rate, `lag` seconds late. Backward Euler: stable at any sampling.
#[derive(Clone, Debug, Default)]
pub(super) struct Steer {
    angle_rad: f32,
    /// What the rate sensor lacks.
    missing_rad_s: f32,
    tracking: bool,
}

impl Steer {
    /// Angle \[rad\] and rate \[rad/s\] after `dt` seconds; without any sensor both are 0.
    pub(super) fn step(&mut self, lag_s: f32, dt: f32, angle: Option<f32>, rate: Option<f32>) -> (f32, f32) {
        let measured = bounded(rate.unwrap_or(0.0), MAX.1);
        let Some(angle) = angle.map(|a| bounded(a, MAX.0)) else {
            *self = Self::default();
            return (0.0, measured);
        };
        if !self.tracking {
            *self = Self { angle_rad: angle, missing_rad_s: 0.0, tracking: true };
        }
        let lag_s = if rate.is_some() && lag_s < FUSED_S { FUSED_S } else { lag_s };
        let w = 2.0 * dt / lag_s;
        let per = 1.0 / ((1.0 + w) * (1.0 + w));
        let ahead = self.angle_rad + dt * (measured + self.missing_rad_s);
        let error = angle - ahead;
        self.angle_rad = bounded(ahead + error * (w * (2.0 + w) * per), MAX.0);
        self.missing_rad_s = bounded(self.missing_rad_s + error * (w * per) * (2.0 / lag_s), MAX.1);
        (self.angle_rad, measured + self.missing_rad_s)
    }
}
