//! Slope of measured over expected change, and block means.

use control::sensors::regression::{BlockMean, Slope, SlopeConfig, SlopePlan};

const CONFIG: SlopeConfig =
    SlopeConfig { highpass_s: 0.3, forget_s: 0.5, max_measured: 20.0, min_excitation: 0.01, settle_s: 0.0 };
const DT_S: f32 = 0.008;

fn plan() -> SlopePlan {
    SlopePlan::new(CONFIG, DT_S)
}

/// Slopes for a swing of 1 Hz whose measured signal is `part` of the expected one plus noise.
fn value(part: f32, noise: f32, steps: usize) -> Vec<Option<f32>> {
    let mut slope = Slope::default();
    let (mut x, mut n) = (0.0, 0.0);
    (1..=steps)
        .map(|i| {
            let next = (core::f32::consts::TAU * DT_S * i as f32).sin();
            // Independent noise: +, +, -, -.
            let noisy = if i / 2 % 2 == 0 { noise } else { -noise };
            let (dx, dn) = (next - x, noisy - n);
            (x, n) = (next, noisy);
            slope.step(&plan(), dx, part * dx + dn)
        })
        .collect()
}

/// Situation: the measured change is a fraction of the expected one.
/// Action: swing for 2 s.
/// Must hold: the slope is that fraction, to rounding; with noise as large as the signal within 0.3 of it.
#[test]
fn the_slope_is_the_measured_fraction() {
    for part in [1.0, 0.3, 0.0, -1.0, -2.0] {
        let clean = value(part, 0.0, 250).pop().flatten().expect("enough");
        assert!((clean - part).abs() < 1e-4, "{part}: {clean}");
        let noisy = value(part, 1.0, 250).pop().flatten().expect("enough");
        assert!((noisy - part).abs() < 0.3, "{part}: {noisy}");
    }
}

/// Situation: no excitation, then a swing.
/// Action: step.
/// Must hold: no slope before the excitation suffices.
#[test]
fn there_is_no_slope_without_excitation() {
    let mut slope = Slope::default();
    assert!((0..1000).all(|_| slope.step(&plan(), 0.0, 1.0).is_none()));
    let first = value(1.0, 0.0, 250).iter().position(Option::is_some).expect("in the end");
    assert!((5..60).contains(&first), "{first}");
}

/// Situation: a settling time of 0.15 s.
/// Action: swing.
/// Must hold: the first slope comes 0.15 s after the one without settling time, within two steps, and is the same.
#[test]
fn the_excitation_must_settle() {
    let settling = SlopePlan::new(SlopeConfig { settle_s: 0.15, ..CONFIG }, DT_S);
    let (mut slope, mut first) = (Slope::default(), None);
    let all = value(1.0, 0.0, 250);
    for i in 1..=250_u16 {
        let swing = |i: u16| (core::f32::consts::TAU * DT_S * f32::from(i)).sin();
        let dx = swing(i) - swing(i - 1);
        if let Some(value) = slope.step(&settling, dx, dx) {
            first.get_or_insert((i, value));
        }
    }
    let at_once = 1 + all.iter().position(Option::is_some).expect("enough");
    let (after, value) = first.expect("enough");
    let late_s = DT_S * (f32::from(after) - at_once as f32);
    assert!((0.13..=0.17).contains(&late_s), "{late_s} s");
    assert!((value - 1.0).abs() < 1e-4, "{value}");
}

/// Situation: the sign reverses after 2 s.
/// Action: step on.
/// Must hold: below 0 within one and a half forgetting time constants, and -1 in the end.
#[test]
fn a_reversal_is_found_soon() {
    let mut slope = Slope::default();
    let mut below = None;
    let mut last = 0.0;
    for i in 1..=500 {
        let swing = |i: i32| (core::f32::consts::TAU * DT_S * i as f32).sin();
        let dx = swing(i) - swing(i - 1);
        let sign = if i > 250 { -1.0 } else { 1.0 };
        last = slope.step(&plan(), dx, sign * dx).unwrap_or(0.0);
        if i > 250 && last < 0.0 && below.is_none() {
            below = Some(i - 250);
        }
    }
    let within = (1.5 * CONFIG.forget_s / DT_S) as i32;
    assert!(below.is_some_and(|steps| (10..=within).contains(&steps)), "{below:?} of {within}");
    assert!((last + 1.0).abs() < 0.1, "{last}");
}

/// Situation: blocks of four periods.
/// Action: add a ramp.
/// Must hold: means of a block and of the previous one, only at its end.
#[test]
fn blocks_have_their_means() {
    let mut block = BlockMean::<2>::default();
    let mut slopes = Vec::new();
    for i in 0..12_i16 {
        let value = f32::from(i);
        block.add([value, -value]);
        slopes.push(if i % 4 == 3 { block.end() } else { None });
    }
    let expected = [(7, [5.5, -5.5], [1.5, -1.5]), (11, [9.5, -9.5], [5.5, -5.5])];
    for (at, now, before) in expected {
        assert_eq!(slopes[at], Some((now, before)));
    }
    assert_eq!(slopes.iter().flatten().count(), expected.len());
}

/// Situation: a block without values, first or between others.
/// Action: end it.
/// Must hold: no means, and no NaN afterwards; the next full block has no previous one.
#[test]
fn an_empty_block_has_no_means() {
    let mut block = BlockMean::<1>::default();
    assert_eq!(block.end(), None);
    let mut full = |value: f32, empty: bool| {
        if !empty {
            block.add([value]);
        }
        block.end()
    };
    assert_eq!(full(1.0, false), None);
    assert_eq!(full(2.0, false), Some(([2.0], [1.0])));
    assert_eq!(full(0.0, true), None);
    assert_eq!(full(3.0, false), None);
    assert_eq!(full(4.0, false), Some(([4.0], [3.0])));
}
