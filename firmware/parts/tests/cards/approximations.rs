//! Flight cards: what micromath is good enough for. The numbers are those of docs/motor.md.

use micromath::F32;
use parts::vesc6::BOARD_HEAT;
use std::f64::consts::PI;

/// The largest of some errors.
fn most(errors: impl Iterator<Item = f64>) -> f64 {
    errors.fold(0.0, f64::max)
}

/// Situation: numbers to be sent, from far below a unit to the ends of the range. Must hold: micromath rounds each as
/// libm does, but for the last number below a half.
#[test]
fn rounding_is_that_of_libm() {
    let apart: Vec<f32> = (0..=u32::MAX)
        .step_by(61)
        .chain([0.499_999_97_f32, -0.499_999_97, 0.5, -0.5, 0.499_999_94, 32_766.5].map(f32::to_bits))
        .map(f32::from_bits)
        .filter(|x| x.abs() < 40_000.0 && F32(*x).round().0 != libm::roundf(*x))
        .collect();
    assert_eq!(apart, [0.499_999_97, -0.499_999_97]);
}

/// Situation: every count of the thermistor from -40 to 180 deg C, its logarithm by micromath. Must hold: up to 7 K
/// from the truth, as its inverse is one of 12 %; as it is done, no more than 0.01 K.
#[test]
fn a_logarithm_below_one_is_no_temperature() {
    let celsius = |ln: f64| 1.0 / (ln / f64::from(BOARD_HEAT.beta_k) + 1.0 / 298.15) - 273.15;
    let (mut by_micromath, mut as_done) = (0.0_f64, 0.0_f64);
    for counts in 17..4079_u16 {
        let ratio = 4095.0 / f32::from(counts) - 1.0;
        let truth = celsius(f64::from(ratio).ln());
        if (-40.0..180.0).contains(&truth) {
            by_micromath = by_micromath.max((celsius(F32(ratio).ln().0.into()) - truth).abs());
            as_done = as_done.max((f64::from(BOARD_HEAT.celsius(counts)) - truth).abs());
        }
    }
    assert!((6.9..7.2).contains(&by_micromath) && as_done < 0.01, "{by_micromath} K, {as_done} K");
}

/// Situation: a turn, and lengths of any size. Must hold: sine and cosine within 1.1e-3, a root within 6.1 %, 1.6e-6
/// after two steps of Newton, whose root of infinity is no number.
#[test]
fn angles_and_lengths_are_rough() {
    let turn = || (-100_000..100_000).map(|i| f64::from(i) * PI / 100_000.0);
    let sine = most(turn().map(|x| (f64::from(F32(x as f32).sin().0) - x.sin()).abs()));
    let cosine = most(turn().map(|x| (f64::from(F32(x as f32).cos().0) - x.cos()).abs()));
    assert!((1.0e-3..1.1e-3).contains(&sine) && (1.0e-3..1.1e-3).contains(&cosine), "{sine} {cosine}");
    let newton = |x: f32, root: f32| 0.5 * (root + x / root);
    let off = |x: f32, root: f32| (f64::from(root) / f64::from(x).sqrt() - 1.0).abs();
    let sizes = || (0x0080_0000..0x7f00_0000).step_by(10_007).map(f32::from_bits);
    let rough = most(sizes().map(|x| off(x, F32(x).sqrt().0)));
    let fine = most(sizes().map(|x| off(x, newton(x, newton(x, F32(x).sqrt().0)))));
    assert!((0.060..0.061).contains(&rough) && (1.4e-6..1.7e-6).contains(&fine), "{rough} {fine}");
    let infinite = newton(f32::INFINITY, newton(f32::INFINITY, F32(f32::INFINITY).sqrt().0));
    assert!(infinite.is_nan());
}
