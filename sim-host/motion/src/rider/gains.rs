//! Feedback signals of a rider and their gains.

use crate::num::Scalar;

/// The symbols of the gains, in the order of [`Gains`] and [`Signals`]. Units: N m per rad, rad s,
/// rad/s, rad/s^2 (roll, then steer), rad (heading), m (lateral deviation).
pub const KEYS: [&str; 10] = [
    "K_phi_p",
    "K_phi_i",
    "K_phi_d",
    "K_phi_dd",
    "K_delta_p",
    "K_delta_i",
    "K_delta_d",
    "K_delta_dd",
    "K_psi",
    "K_y",
];

/// Feedback gains (eqs 2.7 and 2.8; heading and lateral deviation for Hess's family), by [`KEYS`].
/// Positive gains turn the handlebar to the right for a motion to the right.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Gains(pub [f64; 10]);

/// Feedback signals, in the order of [`KEYS`]: roll, its integral, rate and acceleration; the same of steer;
/// heading; lateral deviation of the front contact \[m\]. Right positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signals<S>(pub [S; 10]);

impl Gains {
    /// Gains on roll (p, i, d, dd), then on steer; the others zero.
    pub fn of_states(gains: &[f64; 8]) -> Self {
        let mut all = Self::default();
        all.0[..gains.len()].copy_from_slice(gains);
        all
    }

    /// Gain by its symbol; `None` for an unknown symbol.
    pub fn get(&self, key: &str) -> Option<f64> {
        KEYS.iter().position(|k| *k == key).map(|i| self.0[i])
    }

    /// Neural signal before the delay \[N m\]: the sum of gains times signals.
    #[inline(always)]
    pub fn signal<S: Scalar>(&self, signals: &Signals<S>) -> S {
        let mut sum = signals.0[0] * self.0[0];
        for i in 1..KEYS.len() {
            sum = sum + signals.0[i] * self.0[i];
        }
        sum
    }

    /// Linear interpolation from `self` (`s` = 0) to `other` (`s` = 1).
    #[inline(always)]
    pub fn toward(&self, other: &Gains, s: f64) -> Gains {
        let mut out = *self;
        for (x, to) in out.0.iter_mut().zip(other.0) {
            *x += s * (to - *x);
        }
        out
    }
}
