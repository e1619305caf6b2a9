//! Accuracy of micromath. The errors in the table of docs/motor.md are computed here.

use devices::vesc6::BOARD_TEMPERATURE;
use micromath::F32;
use motor::angle::Angle;
use std::f64::consts::{PI, TAU};

/// The largest of some errors.
fn most(errors: impl Iterator<Item = f64>) -> f64 {
    errors.fold(0.0, f64::max)
}

/// The page's row must have these errors, of this project and of micromath, within a twentieth.
fn holds(row: &str, errors: [f64; 2]) {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/motor.md");
    let page = std::fs::read_to_string(page).expect("the page");
    let line = page.lines().find(|line| line.starts_with(&format!("| {row} |"))).expect(row);
    let cells: Vec<&str> = line.split('|').map(str::trim).collect();
    let documented =
        [2, 4].map(|cell: usize| cells[cell].split(' ').next().and_then(|word| word.parse::<f64>().ok()));
    let same = |(documented, error): (&Option<f64>, &f64)| {
        documented.is_some_and(|documented| (documented - error).abs() <= 0.05 * error)
    };
    assert!(documented.iter().zip(&errors).all(same), "docs/motor.md says\n{line}, here {errors:?}");
}

/// Situation: numbers to be sent, from far below a unit to the ends of the range. Must hold: micromath rounds each as
/// libm does, except the largest number below a half.
#[test]
fn rounding_is_that_of_libm() {
    let apart: Vec<f32> = (0..=u32::MAX)
        .step_by(61)
        .chain([0.499_999_97_f32, -0.499_999_97, 0.5, -0.5, 0.499_999_94, 32_766.5].map(f32::to_bits))
        .map(f32::from_bits)
        .filter(|x| x.abs() < 40_000.0 && F32(*x).round().0 != libm::roundf(*x))
        .collect();
    assert_eq!(apart, [0.499_999_97, -0.499_999_97]);
    let error = most(apart.iter().map(|x| f64::from((F32(*x).round().0 - libm::roundf(*x)).abs())));
    holds("rounding of the values on CAN", [0.0, error]);
}

/// Situation: every count of the thermistor from -40 to 180 deg C, with micromath's logarithm. Must hold: errors up
/// to 7 K, as its reciprocal has an error of 12 %; with the product's functions at most 0.01 K.
#[test]
fn a_logarithm_below_one_is_no_temperature() {
    let celsius = |ln: f64| 1.0 / (ln / f64::from(BOARD_TEMPERATURE.beta_k) + 1.0 / 298.15) - 273.15;
    let (mut by_micromath, mut as_done) = (0.0_f64, 0.0_f64);
    for counts in 17..4079_u16 {
        let ratio = 4095.0 / f32::from(counts) - 1.0;
        let truth = celsius(f64::from(ratio).ln());
        if (-40.0..180.0).contains(&truth) {
            by_micromath = by_micromath.max((celsius(F32(ratio).ln().0.into()) - truth).abs());
            as_done = as_done.max((f64::from(BOARD_TEMPERATURE.celsius(counts)) - truth).abs());
        }
    }
    assert!((6.9..7.2).contains(&by_micromath) && as_done < 0.01, "{by_micromath} K, {as_done} K");
    holds("logarithm of the thermistor", [as_done, by_micromath]);
}

/// Situation: a turn in 200,000 steps. Must hold: the product's sine and cosine within 1e-6, micromath's within 1.1e-3.
#[test]
fn micromaths_angles_are_rough() {
    let turn = || (-100_000..100_000).map(|i| f64::from(i) * PI / 100_000.0);
    let rough = most(turn().map(|x| {
        let (sin, cos) = (F32(x as f32).sin().0, F32(x as f32).cos().0);
        (f64::from(sin) - x.sin()).abs().max((f64::from(cos) - x.cos()).abs())
    }));
    let today = most((0..200_000).map(|i| {
        let angle = Angle(i * (u32::MAX / 200_000));
        let x = TAU * f64::from(angle.0) / 2.0_f64.powi(32);
        let (sin, cos) = angle.sin_cos();
        (f64::from(sin) - x.sin()).abs().max((f64::from(cos) - x.cos()).abs())
    }));
    assert!((1e-8..1e-6).contains(&today) && (1.0e-3..1.1e-3).contains(&rough), "{today} {rough}");
    holds("sine and cosine of the rotor's angle", [today, rough]);
}

/// Situation: lengths of any size. Must hold: the product's root within a rounding; micromath's within 6.1 %, 1.6e-6
/// after two Newton steps, which give NaN for infinity.
#[test]
fn micromaths_lengths_are_rough() {
    let newton = |x: f32, root: f32| 0.5 * (root + x / root);
    let off = |x: f32, root: f32| (f64::from(root) / f64::from(x).sqrt() - 1.0).abs();
    let sizes = || (0x0080_0000..0x7f00_0000).step_by(10_007).map(f32::from_bits);
    let today = most(sizes().map(|x| off(x, libm::sqrtf(x))));
    let rough = most(sizes().map(|x| off(x, F32(x).sqrt().0)));
    let fine = most(sizes().map(|x| off(x, newton(x, newton(x, F32(x).sqrt().0)))));
    assert!((1e-9..6e-8).contains(&today), "{today}");
    assert!((0.060..0.061).contains(&rough) && (1.4e-6..1.7e-6).contains(&fine), "{rough} {fine}");
    let infinite = newton(f32::INFINITY, newton(f32::INFINITY, F32(f32::INFINITY).sqrt().0));
    assert!(infinite.is_nan() && libm::sqrtf(f32::INFINITY) == f32::INFINITY);
    holds("length of a vector, circle limits", [today, rough]);
    holds("the same with two steps of Newton", [today, fine]);
}
