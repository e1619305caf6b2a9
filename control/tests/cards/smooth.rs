//! Flight cards: the roll rate without steps and vibration.

use control::estimate::smooth::{SmoothConfig, SmoothPlan, SmoothState, step};
use proptest::prelude::*;

const PERIOD_S: f32 = 1e-3;

/// What comes out of a gyro with a sample every `every` periods, of a motion given over the periods.
fn smoothed(config: SmoothConfig, every: u16, ticks: u16, motion: impl Fn(u16) -> f32) -> Vec<f32> {
    let (plan, mut state) = (SmoothPlan::new(&config, PERIOD_S), SmoothState::default());
    (0..ticks).map(|k| step(&plan, &mut state, motion(k - k % every), k % every)).collect()
}

const LINE: SmoothConfig = SmoothConfig { interpolate: true, lag_s: 0.0, most_rad_s: None };

proptest! {
    /// Situation: a gyro with a sample in each period, any motion. Action: interpolate. Must hold: every bit passes unchanged.
    #[test]
    fn a_gyro_as_fast_as_the_loop_passes_unchanged(motion in proptest::collection::vec(any::<f32>(), 1..200)) {
        let out = smoothed(LINE, 1, motion.len() as u16, |k| motion[usize::from(k)]);
        let bits = |rates: &[f32]| rates.iter().map(|rate| rate.to_bits()).collect::<Vec<_>>();
        prop_assert_eq!(bits(&out), bits(&motion));
    }
}

/// Situation: gyros of 500 to 20 Hz on a bicycle that rolls ever faster, by 1 rad/s^2. Action: interpolate. Must hold: no period changes by more than
/// that makes in a period, within rounding, where a held sample changes by a whole sampling period's; each sample is
/// reached in the last period before the next.
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

/// Situation: a gyro that falls silent for longer than can be bridged, then speaks. Action: interpolate. Must hold: the sample counts at once.
#[test]
fn after_a_gap_the_sample_counts_at_once() {
    let (plan, mut state) = (SmoothPlan::new(&LINE, PERIOD_S), SmoothState::default());
    step(&plan, &mut state, 1.0, 0);
    for age in 1..=150 {
        assert_eq!(step(&plan, &mut state, 1.0, age), 1.0);
    }
    assert_eq!(step(&plan, &mut state, 3.0, 0), 3.0);
}

/// The size of what comes out of a swing of 1 rad/s.
fn gain(config: SmoothConfig, hz: f32) -> f32 {
    let swing = |k: u16| (core::f32::consts::TAU * hz * PERIOD_S * f32::from(k)).sin();
    smoothed(config, 1, 4000, swing)[2000..].iter().fold(0.0_f32, |most, rate| most.max(rate.abs()))
}

/// Situation: a low-pass of 25 ms that takes away anything. Action: roll rates of 1, 9 and 30 Hz; one that grows by
/// 1 rad/s^2; a constant one. Must hold: the first comes through whole, the second, where its power is halved, with 0.707 of its size, the third
/// with 9 % by the Butterworth formula, all within 4 % of the whole; the growing one 25 ms late, within two periods; the constant is reached.
#[test]
fn the_low_pass_leaves_a_fall_and_takes_vibration() {
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

/// Situation: a low-pass of 25 ms that takes away what is smaller than 0.08 rad/s. Action: vibration of 15 Hz and 0.02 rad/s; a fall that begins
/// with 10 rad/s^2; a blow of 3 rad/s. Must hold: less than 40 % of the vibration is left, and more than 25 %; the fall
/// is never more than 0.045 rad/s behind, where the low-pass alone is by 0.25; the blow is there in its own period, within 0.01 rad/s.
#[test]
fn what_is_fast_and_large_is_not_late() {
    let soft = SmoothConfig { interpolate: false, lag_s: 0.025, most_rad_s: Some(0.08) };
    let hard = SmoothConfig { most_rad_s: None, ..soft };
    let vibration = |k: u16| 0.02 * (core::f32::consts::TAU * 15.0 * PERIOD_S * f32::from(k)).sin();
    let left =
        smoothed(soft, 1, 3000, vibration)[1000..].iter().fold(0.0_f32, |most, rate| most.max(rate.abs()))
            / 0.02;
    assert!((0.25..0.4).contains(&left), "{left}");
    let fall = |k: u16| 10.0 * PERIOD_S * f32::from(k);
    let behind = |config| {
        let out = smoothed(config, 1, 500, fall);
        (0..500).map(|k| fall(k) - out[usize::from(k)]).fold(0.0_f32, f32::max)
    };
    assert!((0.03..0.045).contains(&behind(soft)), "{}", behind(soft));
    assert!((0.24..0.27).contains(&behind(hard)), "{}", behind(hard));
    let blow = smoothed(soft, 1, 100, |k| if k < 50 { 0.0 } else { 3.0 });
    assert!((2.99..3.0).contains(&blow[50]), "{}", blow[50]);
}

proptest! {
    /// Situation: any motion a gyro can tell, any low-pass. Action: smooth. Must hold: what comes out is finite, and between the low-pass and
    /// what went in.
    #[test]
    fn what_comes_out_is_between_the_low_pass_and_the_gyro(
        motion in proptest::collection::vec(-40.0_f32..40.0, 1..200),
        lag_s in 1e-4_f32..0.1,
        most in 1e-3_f32..10.0,
    ) {
        let soft = SmoothConfig { interpolate: false, lag_s, most_rad_s: Some(most) };
        let run = |config| smoothed(config, 1, motion.len() as u16, |k| motion[usize::from(k)]);
        let (soft, hard) = (run(soft), run(SmoothConfig { most_rad_s: None, ..soft }));
        for ((out, low), rate) in soft.iter().zip(&hard).zip(&motion) {
            let slack = 1e-5 * (1.0 + low.abs().max(rate.abs()));
            prop_assert!(out.is_finite());
            prop_assert!(*out >= low.min(*rate) - slack && *out <= low.max(*rate) + slack, "{low} {out} {rate}");
        }
    }
}
