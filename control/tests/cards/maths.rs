//! Flight cards: the polynomials of the control crate.

use control::maths::{PER_ROOT_ERROR, QUARTER, SIN_COS_ERROR, bounded, per_root, sin_cos};

/// Situation: every 61st float of a quarter turn, both ways. Action: compare with double precision. The
/// error must stay within the stated bound, which must be no looser than twice what is needed.
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

/// Situation: every 61st float of two octaves, where all others repeat, and a few far ones. Action: compare one over the
/// root with double precision. Must hold: within the stated bound, which is no looser than twice what is needed.
#[test]
fn one_over_the_root_within_its_bound() {
    let mut worst = 0.0_f64;
    let octaves = (1.0_f32.to_bits()..4.0_f32.to_bits()).step_by(61).map(f32::from_bits);
    for x in octaves.chain([1e-37, 1e-6, 96.2, 3e6, 1e38]) {
        worst = worst.max((f64::from(per_root(x)) * f64::from(x).sqrt() - 1.0).abs());
    }
    println!("largest error {worst:e}");
    let bound = f64::from(PER_ROOT_ERROR);
    assert!(worst < bound && worst > 0.5 * bound, "{worst:e}");
}

/// Situation: zero, negative, infinite, not a number, denormal. Action: one over the root. Must hold: finite.
#[test]
fn one_over_the_root_of_anything_is_finite() {
    for x in [0.0, -0.0, -1.0, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 1e-45, f32::MAX] {
        assert!(per_root(x).is_finite(), "{x}");
    }
    assert_eq!(0.0 * per_root(0.0), 0.0);
}

/// Situation: angles beyond a quarter turn, infinite, not a number, negative zero. Action: take sine
/// and cosine. They must be those of the nearest angle within, of 0, and keep the sign of zero.
#[test]
fn beyond_a_quarter_turn() {
    assert_eq!(sin_cos(7.0), sin_cos(QUARTER));
    assert_eq!(sin_cos(f32::NEG_INFINITY), sin_cos(-QUARTER));
    assert_eq!(sin_cos(f32::NAN), (0.0, 1.0));
    assert_eq!(sin_cos(-0.0).0.to_bits(), (-0.0_f32).to_bits());
    assert_eq!(bounded(-0.0, 1.0).to_bits(), (-0.0_f32).to_bits());
    assert_eq!(bounded(f32::NAN, 1.0), 0.0);
}
