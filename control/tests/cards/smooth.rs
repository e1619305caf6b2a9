//! Smoothing of the roll rate: interpolation and low-pass.

use control::estimate::smooth::{SmoothConfig, SmoothPlan, SmoothState, step};
use proptest::prelude::*;

const PERIOD_S: f32 = 1e-3;

/// Output for a gyro with a sample every `every` periods, of a motion given per period.
fn smoothed(config: SmoothConfig, every: u16, ticks: u16, motion: impl Fn(u16) -> f32) -> Vec<f32> {
    let (plan, mut state) = (SmoothPlan::new(&config, PERIOD_S), SmoothState::default());
    (0..ticks).map(|k| step(&plan, &mut state, motion(k - k % every), k % every)).collect()
}

const LINE: SmoothConfig = SmoothConfig { interpolate: true, lag_s: 0.0, most_rad_s: None };

proptest! {
    /// Situation: a gyro with a sample in each period, arbitrary motion.
    /// Action: interpolate.
    /// Must hold: unchanged to the bit.
    #[test]
    fn a_gyro_as_fast_as_the_loop_passes_unchanged(motion in proptest::collection::vec(any::<f32>(), 1..200)) {
        let out = smoothed(LINE, 1, motion.len() as u16, |k| motion[usize::from(k)]);
        let bits = |rates: &[f32]| rates.iter().map(|rate| rate.to_bits()).collect::<Vec<_>>();
        prop_assert_eq!(bits(&out), bits(&motion));
    }
}

/// Situation: gyros of 500 to 20 Hz on a bicycle with a roll acceleration of 1 rad/s^2.
/// Action: interpolate.
/// Must hold: the change per period is that of the acceleration in one period, within 10 %, where a held sample changes
/// by that of a whole sampling period; each sample is reached in the last period before the next.
#[test]
fn a_slow_gyro_makes_no_steps() {
    for every in [2, 5, 10, 20, 50_u16] {
        let out = smoothed(LINE, every, 400, |k| 1e-3 * f32::from(k));
        let held = smoothed(SmoothConfig::default(), every, 400, |k| 1e-3 * f32::from(k));
        let largest = |rates: &[f32]| rates.windows(2).map(|two| (two[1] - two[0]).abs()).fold(0.0, f32::max);
        let from = 2 * usize::from(every);
        assert!((0.9e-3..1.1e-3).contains(&largest(&out[from..])), "{every}: {}", largest(&out[from..]));
        assert!((largest(&held) - 1e-3 * f32::from(every)).abs() < 1e-5, "{every}: {}", largest(&held));
        for k in (2 * every..400).step_by(usize::from(every)) {
            let reached = out[usize::from(k) - 1];
            let sample = 1e-3 * f32::from(k - every);
            assert!((reached - sample).abs() < 2e-6, "{every}: {reached} for {sample}");
        }
    }
}

/// Situation: a gyro without samples for longer than is interpolated, then a sample.
/// Action: interpolate.
/// Must hold: the sample acts at once.
#[test]
fn after_a_gap_the_sample_acts_at_once() {
    let (plan, mut state) = (SmoothPlan::new(&LINE, PERIOD_S), SmoothState::default());
    step(&plan, &mut state, 1.0, 0);
    for age in 1..=150 {
        assert_eq!(step(&plan, &mut state, 1.0, age), 1.0);
    }
    assert_eq!(step(&plan, &mut state, 3.0, 0), 3.0);
}

/// Output amplitude for a swing of 1 rad/s.
fn gain(config: SmoothConfig, hz: f32) -> f32 {
    let swing = |k: u16| (core::f32::consts::TAU * hz * PERIOD_S * f32::from(k)).sin();
    smoothed(config, 1, 4000, swing)[2000..].iter().fold(0.0_f32, |largest, rate| largest.max(rate.abs()))
}

/// Situation: a low-pass of 25 ms without bound.
/// Action: roll rates of 1, 9 and 30 Hz; a ramp of 1 rad/s^2; a step.
/// Must hold: amplitudes by the Butterworth formula within 0.04: unchanged, 0.707 at the half-power frequency, 9 %; the
/// ramp 25 ms late, within two periods; the step is reached.
#[test]
fn the_low_pass_keeps_a_fall_and_removes_vibration() {
    let low = SmoothConfig { interpolate: false, lag_s: 0.025, most_rad_s: None };
    let cutoff_hz = 1.0 / (core::f32::consts::SQRT_2 * core::f32::consts::PI * low.lag_s);
    for hz in [1.0, cutoff_hz, 30.0] {
        let formula = 1.0 / (1.0 + (hz / cutoff_hz).powi(4)).sqrt();
        let gain = gain(low, hz);
        assert!((gain - formula).abs() < 0.04, "{hz} Hz: {gain} for {formula}");
    }
    let ramp = smoothed(low, 1, 1000, |k| 1e-3 * f32::from(k));
    let late_s = 0.999 - ramp[999];
    assert!((0.024..0.027).contains(&late_s), "{late_s}");
    let constant = smoothed(low, 1, 400, |k| if k == 0 { 0.0 } else { 1.0 });
    assert!((1.0 - constant[399]).abs() < 1e-5, "{}", constant[399]);
}

/// Situation: a low-pass of 25 ms bounded to 0.08 rad/s.
/// Action: vibration of 15 Hz and 0.02 rad/s; a fall with 10 rad/s^2; an impact of 3 rad/s.
/// Must hold: 25 to 40 % of the vibration remains; the fall is at most 0.045 rad/s behind, 0.25 with the low-pass
/// alone; the impact passes in its own period, within 0.01 rad/s.
#[test]
fn fast_large_changes_are_not_delayed() {
    let bounded = SmoothConfig { interpolate: false, lag_s: 0.025, most_rad_s: Some(0.08) };
    let unbounded = SmoothConfig { most_rad_s: None, ..bounded };
    let vibration = |k: u16| 0.02 * (core::f32::consts::TAU * 15.0 * PERIOD_S * f32::from(k)).sin();
    let left = smoothed(bounded, 1, 3000, vibration)[1000..]
        .iter()
        .fold(0.0_f32, |largest, rate| largest.max(rate.abs()))
        / 0.02;
    assert!((0.25..0.4).contains(&left), "{left}");
    let fall = |k: u16| 10.0 * PERIOD_S * f32::from(k);
    let behind = |config| {
        let out = smoothed(config, 1, 500, fall);
        (0..500).map(|k| fall(k) - out[usize::from(k)]).fold(0.0_f32, f32::max)
    };
    assert!((0.03..0.045).contains(&behind(bounded)), "{}", behind(bounded));
    assert!((0.24..0.27).contains(&behind(unbounded)), "{}", behind(unbounded));
    let impact = smoothed(bounded, 1, 100, |k| if k < 50 { 0.0 } else { 3.0 });
    assert!((2.99..3.0).contains(&impact[50]), "{}", impact[50]);
}

proptest! {
    /// Situation: arbitrary motion within a gyro's range, arbitrary low-pass.
    /// Action: smooth.
    /// Must hold: the output is finite, and between the low-pass and the input.
    #[test]
    fn the_output_is_between_the_low_pass_and_the_gyro(
        motion in proptest::collection::vec(-40.0_f32..40.0, 1..200),
        lag_s in 1e-4_f32..0.1,
        largest in 1e-3_f32..10.0,
    ) {
        let bounded = SmoothConfig { interpolate: false, lag_s, most_rad_s: Some(largest) };
        let run = |config| smoothed(config, 1, motion.len() as u16, |k| motion[usize::from(k)]);
        let (bounded, unbounded) = (run(bounded), run(SmoothConfig { most_rad_s: None, ..bounded }));
        for ((out, low), rate) in bounded.iter().zip(&unbounded).zip(&motion) {
            let slack = 1e-5 * (1.0 + low.abs().max(rate.abs()));
            prop_assert!(out.is_finite());
            prop_assert!(*out >= low.min(*rate) - slack && *out <= low.max(*rate) + slack, "{low} {out} {rate}");
        }
    }
}
