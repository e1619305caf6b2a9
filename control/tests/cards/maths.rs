//! Sine, cosine, exponential and reciprocal square root of the control crate.

use control::maths::{QUARTER, RSQRT_ERROR, SIN_COS_ERROR, bounded, exp, is_finite, rsqrt, sin_cos};

/// Situation: every 61st float within a quarter turn, both signs.
/// Action: compare with double precision.
/// Must hold: the error is within the stated bound, and the bound is at most twice the error.
#[test]
fn sine_and_cosine_within_their_bound() {
    let mut worst = 0.0_f64;
    for bits in (0..=QUARTER.to_bits()).step_by(61) {
        let x = f32::from_bits(bits);
        let (s, c) = sin_cos(x);
        let (exact_s, exact_c) = f64::from(x).sin_cos();
        worst = worst.max((f64::from(s) - exact_s).abs()).max((f64::from(c) - exact_c).abs());
        let (s_left, c_left) = sin_cos(-x);
        assert!(s_left == -s && c_left == c, "{x}");
    }
    println!("largest error {worst:e}");
    let bound = f64::from(SIN_COS_ERROR);
    assert!(worst < bound && worst > 0.5 * bound, "{worst:e}");
}

/// Situation: every 61st float of two octaves, after which the function repeats, and a few distant ones.
/// Action: compare the reciprocal square root with double precision.
/// Must hold: the error is within the stated bound, and the bound is at most twice the error.
#[test]
fn the_reciprocal_root_within_its_bound() {
    let mut worst = 0.0_f64;
    let octaves = (1.0_f32.to_bits()..4.0_f32.to_bits()).step_by(61).map(f32::from_bits);
    for x in octaves.chain([1e-37, 1e-6, 96.2, 3e6, 1e38]) {
        worst = worst.max((f64::from(rsqrt(x)) * f64::from(x).sqrt() - 1.0).abs());
    }
    println!("largest error {worst:e}");
    let bound = f64::from(RSQRT_ERROR);
    assert!(worst < bound && worst > 0.5 * bound, "{worst:e}");
}

/// Situation: every 61st finite float from zero, including denormals and the largest.
/// Action: compute the reciprocal square root.
/// Must hold: finite and positive.
#[test]
fn the_reciprocal_root_is_finite() {
    for x in (0..=f32::MAX.to_bits()).step_by(61).map(f32::from_bits).chain([f32::MAX]) {
        assert!(rsqrt(x).is_finite() && rsqrt(x) > 0.0, "{x}");
    }
    assert_eq!(0.0 * rsqrt(0.0), 0.0);
}

/// Situation: angles beyond a quarter turn, infinite, NaN, negative zero.
/// Action: compute sine and cosine.
/// Must hold: those of the nearest angle within, of 0 for NaN, with the sign of zero unchanged.
#[test]
fn beyond_a_quarter_turn() {
    assert_eq!(sin_cos(7.0), sin_cos(QUARTER));
    assert_eq!(sin_cos(f32::NEG_INFINITY), sin_cos(-QUARTER));
    assert_eq!(sin_cos(f32::NAN), (0.0, 1.0));
    assert_eq!(sin_cos(-0.0).0.to_bits(), (-0.0_f32).to_bits());
    assert_eq!(bounded(-0.0, 1.0).to_bits(), (-0.0_f32).to_bits());
    assert_eq!(bounded(f32::NAN, 1.0), 0.0);
}

/// Situation: every 61st float, both signs, and the neighbours of the limits of the short path.
/// Action: compute the exponential by the short path and by libm.
/// Must hold: the same bits.
#[test]
fn the_exponential_has_the_bits_of_libm() {
    let edges = [1.220_703_1e-4_f32, 0.5 * std::f32::consts::LN_2, 1.5 * std::f32::consts::LN_2, 87.0, 88.8];
    let near =
        edges.into_iter().flat_map(|edge| (edge.to_bits() - 9..edge.to_bits() + 9).map(f32::from_bits));
    let every = (0..=f32::INFINITY.to_bits()).step_by(61).map(f32::from_bits);
    for x in every.chain(near) {
        for x in [x, -x] {
            assert_eq!(exp(x).to_bits(), libm::expf(x).to_bits(), "{x:e}");
        }
    }
    assert!(exp(f32::NAN).is_nan());
}

/// Situation: zero, the smallest and the largest float, infinity, NaN, both signs.
/// Action: test for finiteness.
/// Must hold: the result of `f32::is_finite`.
#[test]
fn is_finite_agrees_with_the_standard_library() {
    for x in [0.0, 1.0, 1e-45, f32::MIN_POSITIVE, f32::MAX, f32::INFINITY, f32::NAN] {
        assert_eq!([is_finite(x), is_finite(-x)], [x.is_finite(); 2], "{x:e}");
    }
}
