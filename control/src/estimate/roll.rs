//! Roll angle and the roll gyro's bias: a Kalman filter of two states.
//!
//! The roll rate is integrated; the measured lateral force corrects the integral. The observation is that of Sanjurjo
//! et al. 2019 (roll of a bicycle from rates and speed); an accelerometer, where fitted, replaces the steady-cornering
//! assumption.

use crate::maths::{QUARTER, bounded, max};

/// Largest innovation of one observation that is used in full \[rad\].
pub const MAX_INNOVATION_RAD: f32 = 0.3;

/// Variance of an unknown roll angle \[rad^2\].
const UNKNOWN_RAD2: f32 = 1.0;

/// Filter state: the estimates and the covariance of their errors.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub(super) struct Roll {
    /// Roll \[rad\].
    pub(super) angle_rad: f32,
    /// Bias of the rate \[rad/s\].
    pub(super) bias_rad_s: f32,
    /// Variance of the roll angle, covariance, variance of the bias.
    p11: f32,
    p12: f32,
    p22: f32,
}

impl Roll {
    /// Unknown roll angle, and a bias within `bias_max` at three standard deviations.
    pub(super) fn unknown(bias_max: f32) -> Self {
        Self { p11: UNKNOWN_RAD2, p22: bias_max * bias_max / 9.0, ..Self::default() }
    }

    /// Variance of the roll angle, covariance, variance of the bias.
    pub(super) fn covariance(&self) -> [f32; 3] {
        [self.p11, self.p12, self.p22]
    }

    /// Three standard deviations of the roll angle, squared \[rad^2\].
    pub(super) fn spread(&self) -> f32 {
        9.0 * self.p11
    }

    /// Integrates the bias-corrected `rate` for `dt` seconds; `walks` are the standard deviations of angle and bias
    /// after one second.
    pub(super) fn integrate(&mut self, rate: f32, dt: f32, walks: (f32, f32), bias_max: f32) {
        self.angle_rad = bounded(self.angle_rad + rate * dt, QUARTER);
        self.p11 += dt * (walks.0 * walks.0 - 2.0 * self.p12 + dt * self.p22);
        self.p12 -= dt * self.p22;
        self.p22 += dt * walks.1 * walks.1;
        // The variances never exceed the initial ones; scaling the covariance with them keeps the matrix valid.
        let max_variance = bias_max * bias_max / 9.0;
        if self.p22 > max_variance {
            self.p12 *= max_variance / self.p22;
            self.p22 = max_variance;
        }
        if self.p11 > UNKNOWN_RAD2 {
            self.p12 *= UNKNOWN_RAD2 / self.p11;
            self.p11 = UNKNOWN_RAD2;
        }
    }

    /// Updates with an observation: the roll angle is `error` above the estimate, with `variance`.
    pub(super) fn observe(&mut self, error: f32, variance: f32, bias_max: f32) {
        let per = 1.0 / (self.p11 + variance);
        let (k1, k2) = (self.p11 * per, self.p12 * per);
        self.correct(k1, k2, bounded(error, MAX_INNOVATION_RAD), bias_max);
        self.p22 = max(0.0, self.p22 - k2 * self.p12);
        self.p12 -= k2 * self.p11;
        self.p11 -= k1 * self.p11;
    }

    /// Updates with an observation: the bias is `error` above the estimate, with `variance`.
    pub(super) fn observe_bias(&mut self, error: f32, variance: f32, bias_max: f32) {
        let per = 1.0 / (self.p22 + variance);
        let (k1, k2) = (self.p12 * per, self.p22 * per);
        self.correct(k1, k2, error, bias_max);
        self.p11 = max(0.0, self.p11 - k1 * self.p12);
        self.p12 -= k1 * self.p22;
        self.p22 -= k2 * self.p22;
    }

    fn correct(&mut self, k1: f32, k2: f32, error: f32, bias_max: f32) {
        self.angle_rad = bounded(self.angle_rad + k1 * error, QUARTER);
        self.bias_rad_s = bounded(self.bias_rad_s + k2 * error, bias_max);
    }
}
