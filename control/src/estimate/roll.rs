//! Roll angle and the roll gyro's bias: a Kalman filter of two states.
//!
//! The rate is summed up; what sideways force there is shows the sum's error. The observation is
//! that of Sanjurjo et al. 2019 (roll of a bicycle from rates and speed), with an accelerometer in
//! place of the steady-cornering assumption where there is one.

use crate::maths::{QUARTER, bounded, max};

/// How far one observation may be off and still count in full \[rad\].
const SURPRISE_RAD: f32 = 0.3;

/// Largest variance of the roll angle: nothing is known \[rad^2\].
const ANYTHING: f32 = 1.0;

/// The filter's memory: the estimates and the covariance of their errors.
#[derive(Clone, Debug, Default)]
pub(super) struct Roll {
    /// Roll \[rad\].
    pub(super) angle_rad: f32,
    /// Bias of the rate \[rad/s\].
    pub(super) bias_rad_s: f32,
    /// Variances of roll and bias, and what they have in common.
    p11: f32,
    p12: f32,
    p22: f32,
}

impl Roll {
    /// Nothing known but that the bias is within `bias_max`, at three standard deviations.
    pub(super) fn unknown(bias_max: f32) -> Self {
        Self { p11: ANYTHING, p22: bias_max * bias_max / 9.0, ..Self::default() }
    }

    /// Three standard deviations of the roll angle, squared \[rad^2\].
    pub(super) fn spread(&self) -> f32 {
        9.0 * self.p11
    }

    /// Turns by `rate` (bias already off) for `dt` seconds; `walks` are the standard deviations of
    /// angle and bias after one second.
    pub(super) fn turn(&mut self, rate: f32, dt: f32, walks: (f32, f32), bias_max: f32) {
        self.angle_rad = bounded(self.angle_rad + rate * dt, QUARTER);
        self.p11 += dt * (walks.0 * walks.0 - 2.0 * self.p12 + dt * self.p22);
        self.p12 -= dt * self.p22;
        self.p22 += dt * walks.1 * walks.1;
        // Never less known than at first; scaled as a whole, so that it stays a covariance.
        let most = bias_max * bias_max / 9.0;
        if self.p22 > most {
            self.p12 *= most / self.p22;
            self.p22 = most;
        }
        if self.p11 > ANYTHING {
            self.p12 *= ANYTHING / self.p11;
            self.p11 = ANYTHING;
        }
    }

    /// Takes in that the roll angle is `error` more than estimated, seen with `variance`.
    pub(super) fn observe(&mut self, error: f32, variance: f32, bias_max: f32) {
        let per = 1.0 / (self.p11 + variance);
        let (k1, k2) = (self.p11 * per, self.p12 * per);
        self.correct(k1, k2, bounded(error, SURPRISE_RAD), bias_max);
        self.p22 = max(0.0, self.p22 - k2 * self.p12);
        self.p12 -= k2 * self.p11;
        self.p11 -= k1 * self.p11;
    }

    /// Takes in that the bias is `error` more than estimated, seen with `variance`; the gain.
    pub(super) fn observe_bias(&mut self, error: f32, variance: f32, bias_max: f32) -> f32 {
        let per = 1.0 / (self.p22 + variance);
        let (k1, k2) = (self.p12 * per, self.p22 * per);
        self.correct(k1, k2, error, bias_max);
        self.p11 = max(0.0, self.p11 - k1 * self.p12);
        self.p12 -= k1 * self.p22;
        self.p22 -= k2 * self.p22;
        k2
    }

    fn correct(&mut self, k1: f32, k2: f32, error: f32, bias_max: f32) {
        self.angle_rad = bounded(self.angle_rad + k1 * error, QUARTER);
        self.bias_rad_s = bounded(self.bias_rad_s + k2 * error, bias_max);
    }
}
