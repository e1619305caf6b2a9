//! Sine and cosine for leans, where the standard ones would cost more than the law.
//!
//! Polynomials through the Chebyshev nodes of the quarter turn. `+`, `-` and `*` only: host and chip
//! agree in every bit, and `sin(-x)` is `-sin(x)` to the bit.

use core::f32::consts::LOG2_E;
use core::hint::cold_path;

/// Gravity \[m/s^2\].
pub const G: f32 = 9.81;

/// A quarter turn \[rad\].
pub const QUARTER: f32 = core::f32::consts::FRAC_PI_2;

/// Whether `x` is finite, without a detour through the integer registers: infinite or NaN times 0 is NaN.
#[inline]
pub fn is_finite(x: f32) -> bool {
    x * 0.0 == 0.0
}

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
        return x;
    }
    cold_path();
    if x > max {
        max
    } else if x < -max {
        -max
    } else {
        0.0
    }
}

/// `e` to the power of `x`: the bits of [`libm::expf`], whose arithmetic this is (musl, after FreeBSD's `e_expf.c`), without
/// its branches where none is needed.
#[inline]
pub fn exp(x: f32) -> f32 {
    let size = x.abs();
    if !(size > 1.220_703_1e-4 && size <= 87.0) {
        cold_path();
        return libm::expf(x);
    }
    // x = k ln 2 + r, ln 2 in two parts, of which the upper one times k is exact.
    let k = (LOG2_E * x + if x < 0.0 { -0.5 } else { 0.5 }) as i32;
    let (upper, lower) = (x - k as f32 * 0.693_145_75, k as f32 * 1.428_606_8e-6);
    let r = upper - lower;
    let rr = r * r;
    let c = r - rr * (0.166_666_25 - rr * 0.002_766_733_3);
    let power = 1.0 + (r * c / (2.0 - c) - lower + upper);
    power * f32::from_bits(((127 + k) as u32) << 23)
}

/// Largest relative error of [`rsqrt`], for what is neither 0, denormal nor beyond `1e38`.
pub const PER_ROOT_ERROR: f32 = 2e-7;

/// One over the square root of a number that is known to be neither negative nor infinite nor NaN; finite for 0 too. A
/// square root in software takes four times as long.
#[inline]
pub fn rsqrt(x: f32) -> f32 {
    // Half the exponent, negated, with the constant of least error; each of Newton's steps squares it.
    let guess = f32::from_bits(0x5f37_5a86_u32.wrapping_sub(x.to_bits() >> 1));
    let better = guess * (1.5 - 0.5 * x * guess * guess);
    let better = better * (1.5 - 0.5 * x * better * better);
    better * (1.5 - 0.5 * x * better * better)
}

/// The lesser; `x` if they are equal or `bound` is NaN. `f32::min` is a call on the chip.
#[inline]
pub fn min(bound: f32, x: f32) -> f32 {
    if x > bound { bound } else { x }
}

/// The greater; `x` if they are equal or `bound` is NaN.
#[inline]
pub fn max(bound: f32, x: f32) -> f32 {
    if x < bound { bound } else { x }
}
