//! The rear frame's pitch from roll and steer, with both wheels on the ground.
//!
//! With the rear wheel on the ground, the height of the front wheel's lowest point is a function of roll,
//! steer and pitch. Newton's method finds its root from a close guess, so that the root is the one continuous
//! with the upright bicycle (another root is the bicycle upside down). See `docs/bicycle.md`, section 3.

use super::Geometry;
use crate::num::{Scalar, sin_cos};
use std::f64::consts::PI;

/// Newton iterations from the guess that a time step provides. The guess has an error of the order of the
/// step squared, below 1e-4 rad, so that two iterations leave only rounding errors.
const ITERATIONS: usize = 2;

/// Sines and cosines of the configuration, with the front wheel on the ground.
#[derive(Clone, Copy, Debug)]
pub struct Attitude<S> {
    /// Sine and cosine of roll.
    pub roll: (S, S),
    /// Sine and cosine of steer.
    pub steer: (S, S),
    /// Sine and cosine of the steer axis tilt plus pitch.
    pub tilt: (S, S),
    /// Pitch relative to the upright bicycle \[rad\], nose up positive.
    pub pitch: S,
}

/// Depth of the front wheel's lowest point below the ground \[m\], and its derivative with respect to pitch
/// \[m\].
#[inline(always)]
fn front_contact<S: Scalar>(b: &Geometry, (sr, cr): (S, S), (sd, cd): (S, S), (st, ct): (S, S)) -> (S, S) {
    // Cosine of the angle between the front axle and the vertical, and the sine.
    let n = sd * st * cr + cd * sr;
    let m = (S::constant(1.0) - n * n).sqrt();
    let depth = cr * (st * -b.d1 + ct * b.d2 + -b.rR) + (sd * sr - cd * st * cr) * b.d3 + m * b.rF;
    let slope = -(cr * (ct * b.d1 + st * b.d2 + cd * ct * b.d3)) - n / m * (sd * ct * cr) * b.rF;
    (depth, slope)
}

/// The attitude with the front wheel on the ground, by Newton's method from `guess` \[rad\], which must be
/// within about 1e-3 rad of the root.
#[inline(always)]
pub(super) fn attitude<S: Scalar>(b: &Geometry, roll: S, steer: S, guess: S) -> Attitude<S> {
    let (roll, steer) = (roll.sin_cos(), steer.sin_cos());
    let mut pitch = guess;
    let (mut s, mut c) = (guess + b.lam).sin_cos();
    for _ in 0..ITERATIONS {
        let (depth, slope) = front_contact(b, roll, steer, (s, c));
        let e = -(depth / slope);
        pitch = pitch + e;
        // Angle addition; the correction is small enough for its Taylor series.
        let q = e * e;
        let (se, ce) =
            (e * (q * (q * (1.0 / 120.0) + -1.0 / 6.0) + 1.0), q * (q * (1.0 / 24.0) + -0.5) + 1.0);
        (s, c) = (s * ce + c * se, c * ce - s * se);
    }
    Attitude { roll, steer, tilt: (s, c), pitch }
}

/// The pitch \[rad\] of any attitude, continued from the upright bicycle in small steps.
///
/// `None` if the continuation fails because the front wheel can't reach the ground, and beyond half a turn of
/// roll or steer.
pub fn pitch_from_upright(b: &Geometry, roll: f64, steer: f64) -> Option<f64> {
    if !(roll.abs() <= PI && steer.abs() <= PI) {
        return None;
    }
    let steps = (roll.abs().max(steer.abs()) / 0.04).ceil().max(1.0);
    let mut pitch = 0.0;
    for i in 1..=steps as usize {
        let part = i as f64 / steps;
        let (r, d) = (sin_cos(roll * part), sin_cos(steer * part));
        for _ in 0..4 {
            let (depth, slope) = front_contact(b, r, d, sin_cos(pitch + b.lam));
            pitch -= depth / slope;
        }
    }
    let residual = front_contact(b, sin_cos(roll), sin_cos(steer), sin_cos(pitch + b.lam)).0;
    (residual.abs() < 1e-12).then_some(pitch)
}

/// Depth of the front wheel's lowest point below the ground \[m\]; 0 except for rounding if `pitch` belongs
/// to `roll` and `steer`.
pub fn front_contact_residual(b: &Geometry, roll: f64, steer: f64, pitch: f64) -> f64 {
    front_contact(b, sin_cos(roll), sin_cos(steer), sin_cos(pitch + b.lam)).0
}
