//! Sine and cosine for leans, where the standard ones would cost more than the law.
//!
//! Polynomials through the Chebyshev nodes of the quarter turn. `+`, `-` and `*` only: host and chip
//! agree in every bit, and `sin(-x)` is `-sin(x)` to the bit.

/// A quarter turn \[rad\].
pub const QUARTER: f32 = core::f32::consts::FRAC_PI_2;

/// Largest error of [`sin_cos`] within a quarter turn either way, rounding included.
pub const SIN_COS_ERROR: f32 = 2e-7;

/// Sine and cosine of an angle \[rad\]; one beyond a quarter turn counts as a quarter turn, NaN as 0.
#[inline]
pub fn sin_cos(angle_rad: f32) -> (f32, f32) {
    sin_cos_within(bounded(angle_rad, QUARTER))
}

/// The same of an angle \[rad\] that is known to be within a quarter turn; of others it is not.
#[inline]
pub fn sin_cos_within(x: f32) -> (f32, f32) {
    let q = x * x;
    let odd = -0.166_666_66 + q * (0.008_333_242 + q * (-0.000_198_227_4 + q * 2.634_756e-6));
    let even = 0.041_666_66 + q * (-0.001_388_865_2 + q * (2.477_458e-5 + q * -2.629_751e-7));
    (x * (1.0 + q * odd), 1.0 + q * (-0.5 + q * even))
}

/// `x` limited to `max` either way, NaN made 0; a value inside keeps its bits.
#[inline]
pub fn bounded(x: f32, max: f32) -> f32 {
    // What is inside, as nearly always, takes one comparison.
    if x.abs() <= max {
        x
    } else if x > max {
        max
    } else if x < -max {
        -max
    } else {
        0.0
    }
}

/// Largest relative error of [`per_root`], for what is neither 0, denormal nor beyond `1e38`.
pub const PER_ROOT_ERROR: f32 = 2e-7;

/// One over the square root, for positive numbers; finite for every other. A square root in software takes four times
/// as long.
#[inline]
pub fn per_root(x: f32) -> f32 {
    // Half the exponent, negated, with the constant of least error; each of Newton's steps squares it.
    let guess = f32::from_bits(0x5f37_5a86_u32.wrapping_sub((x.to_bits() & 0x7fff_ffff) >> 1));
    let better = guess * (1.5 - 0.5 * x * guess * guess);
    let better = better * (1.5 - 0.5 * x * better * better);
    let best = better * (1.5 - 0.5 * x * better * better);
    bounded(best, f32::MAX)
}

/// The lesser; `x` if they are equal or `bound` is NaN. `f32::min` is a call on the chip.
#[inline]
pub fn at_most(bound: f32, x: f32) -> f32 {
    if x > bound { bound } else { x }
}

/// The greater; `x` if they are equal or `bound` is NaN.
#[inline]
pub fn at_least(bound: f32, x: f32) -> f32 {
    if x < bound { bound } else { x }
}
