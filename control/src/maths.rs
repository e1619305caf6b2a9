//! Fast sine, cosine, exponential and reciprocal square root, where the standard functions would take longer than the
//! control law.
//!
//! Sine and cosine are polynomials through the Chebyshev nodes of the quarter turn. They use `+`, `-` and `*` only:
//! host and chip results are bit-identical, and `sin(-x)` is exactly `-sin(x)`.

use core::f32::consts::LOG2_E;
use core::hint::cold_path;

/// Gravity \[m/s^2\].
pub const G: f32 = 9.81;

/// A quarter turn \[rad\].
pub const QUARTER: f32 = core::f32::consts::FRAC_PI_2;

/// Whether `x` is finite, without using the integer registers: infinity or NaN times 0 is NaN.
#[inline]
pub fn is_finite(x: f32) -> bool {
    x * 0.0 == 0.0
}

/// Largest error of [`sin_cos`] within +-90 degrees, rounding included.
pub const SIN_COS_ERROR: f32 = 2e-7;

/// Sine and cosine of an angle \[rad\]. Angles beyond a quarter turn are limited to it, NaN gives those of 0.
#[inline]
pub fn sin_cos(angle_rad: f32) -> (f32, f32) {
    sin_cos_within(bounded(angle_rad, QUARTER))
}

/// Sine and cosine of an angle \[rad\] known to be within a quarter turn; not accurate for other angles.
#[inline]
pub fn sin_cos_within(x: f32) -> (f32, f32) {
    let q = x * x;
    let odd = -0.166_666_66 + q * (0.008_333_242 + q * (-0.000_198_227_4 + q * 2.634_756e-6));
    let even = 0.041_666_66 + q * (-0.001_388_865_2 + q * (2.477_458e-5 + q * -2.629_751e-7));
    (x * (1.0 + q * odd), 1.0 + q * (-0.5 + q * even))
}

/// `x` limited to `-max..=max`, NaN replaced by 0; a value inside is unchanged to the bit.
#[inline]
pub fn bounded(x: f32, max: f32) -> f32 {
    // The common case, inside, takes one comparison.
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

/// `e` to the power of `x`, bit-identical to [`libm::expf`]: the same arithmetic (musl, after FreeBSD's `e_expf.c`)
/// without the branches that are not needed.
#[inline]
pub fn exp(x: f32) -> f32 {
    let size = x.abs();
    if !(size > 1.220_703_1e-4 && size <= 87.0) {
        cold_path();
        return libm::expf(x);
    }
    // x = k ln 2 + r, with ln 2 split into two parts; the upper part times k is exact.
    let k = (LOG2_E * x + if x < 0.0 { -0.5 } else { 0.5 }) as i32;
    let (upper, lower) = (x - k as f32 * 0.693_145_75, k as f32 * 1.428_606_8e-6);
    let r = upper - lower;
    let rr = r * r;
    let c = r - rr * (0.166_666_25 - rr * 0.002_766_733_3);
    let power = 1.0 + (r * c / (2.0 - c) - lower + upper);
    power * f32::from_bits(((127 + k) as u32) << 23)
}

/// Largest relative error of [`rsqrt`], except for 0, denormals and numbers beyond `1e38`.
pub const RSQRT_ERROR: f32 = 2e-7;

/// Reciprocal square root of a number known to be neither negative, infinite nor NaN; finite for 0 too. A square root
/// in software takes four times as long.
#[inline]
pub fn rsqrt(x: f32) -> f32 {
    // Initial guess: half the exponent, negated, with the constant of smallest error. Each Newton step squares the
    // error.
    let guess = f32::from_bits(0x5f37_5a86_u32.wrapping_sub(x.to_bits() >> 1));
    let refined = guess * (1.5 - 0.5 * x * guess * guess);
    let refined = refined * (1.5 - 0.5 * x * refined * refined);
    refined * (1.5 - 0.5 * x * refined * refined)
}

/// The smaller of both; `x` if they are equal or `bound` is NaN. `f32::min` is a function call on the chip.
#[inline]
pub fn min(bound: f32, x: f32) -> f32 {
    if x > bound { bound } else { x }
}

/// The larger of both; `x` if they are equal or `bound` is NaN.
#[inline]
pub fn max(bound: f32, x: f32) -> f32 {
    if x < bound { bound } else { x }
}
