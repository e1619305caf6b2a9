//! Flight cards: the roll rate without steps and vibration.

use control::smooth::{SmoothConfig, SmoothPlan, SmoothState, step};
use proptest::prelude::*;

const PERIOD_S: f32 = 1e-3;

/// What comes out of a gyro with a sample every `every` periods, of a motion given over the periods.
fn smoothed(config: SmoothConfig, every: u16, ticks: u16, motion: impl Fn(u16) -> f32) -> Vec<f32> {
    let (plan, mut state) = (SmoothPlan::new(&config, PERIOD_S), SmoothState::default());
    (0..ticks).map(|k| step(&plan, &mut state, motion(k - k % every), k % every)).collect()
}

const LINE: SmoothConfig = SmoothConfig { interpolate: true, lag_s: 0.0 };

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

/// Situation: a low-pass of 8 ms. Action: roll rates of 1 and 60 Hz; a constant one. Must hold: the fall's comes through with more than 99 % of its
/// size, the vibration with 25 to 40 %, by the formula of the first order 32 %; the constant is reached to 1e-5.
#[test]
fn the_low_pass_leaves_a_fall_and_takes_vibration() {
    let low = SmoothConfig { interpolate: false, lag_s: 0.008 };
    for (hz, least, most) in [(1.0, 0.99, 1.0), (60.0, 0.25, 0.40)] {
        let swing = |k: u16| (core::f32::consts::TAU * hz * PERIOD_S * f32::from(k)).sin();
        let out = smoothed(low, 1, 3000, swing);
        let size = out[1000..].iter().fold(0.0_f32, |most, rate| most.max(rate.abs()));
        assert!((least..=most).contains(&size), "{hz} Hz: {size}");
    }
    let (plan, mut state) = (SmoothPlan::new(&low, PERIOD_S), SmoothState::default());
    step(&plan, &mut state, 0.0, 0);
    let last = (0..200).map(|_| step(&plan, &mut state, 1.0, 0)).last().expect("some");
    assert!((1.0 - last).abs() < 1e-5, "{last}");
}
