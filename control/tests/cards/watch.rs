//! Flight cards: one sensor watched.

use control::frame::MISSING;
use control::watch::{Codes, Told, Watch};
use control::{Cause, Loss, Sensor};
use proptest::prelude::*;

const CODES: Codes = Codes {
    lost: Cause::SteerLost,
    range: Cause::SteerRange,
    jump: Cause::SteerJump,
    stuck: Cause::SteerStuck,
};

/// Up to 10, 100 a second (0.1 a period), 5 periods late at most, stuck after 8, 3 good ones to be believed.
const SENSOR: Sensor = Sensor {
    fitted: true,
    max: 10.0,
    step: 0.0,
    slope_per_s: Some(100.0),
    timeout_ticks: 5,
    stuck_ticks: 8,
    qualify_samples: 3,
    loss: Loss::Limp,
};

struct Bench(Watch<1>);

impl Bench {
    fn step(&mut self, value: f32, age: u16, moves: bool) -> Told<1> {
        self.0.step(&SENSOR, &CODES, 1e-3, ([value], age), moves)
    }

    /// A fresh sample: what is believed of it, or why it is not.
    fn fresh(&mut self, value: f32) -> Result<(f32, u16), Option<Cause>> {
        let told = self.step(value, 0, false);
        told.value.map(|([v], age)| (v, age)).ok_or(told.lost)
    }

    /// Believed, the last sample 1.0.
    fn trusted() -> Self {
        let mut bench = Self(Watch::default());
        for k in 0..3 {
            assert_eq!(bench.fresh(1.0 + 1e-3 * k as f32).is_ok(), k == 2, "{k}");
        }
        bench
    }
}

/// Situation: a sensor that is not fitted. Action: any sample. Must hold: never believed, never lost.
#[test]
fn what_is_not_there_is_not_missed() {
    let mut watch = Watch::<1>::default();
    for k in 0..100 {
        let told = watch.step(&Sensor::default(), &CODES, 1e-3, ([f32::NAN], k), true);
        assert_eq!(told, Told { value: None, lost: None });
    }
}

/// Situation: just started. Action: good samples. Must hold: believed from the third on, lost before.
#[test]
fn it_must_prove_itself() {
    let mut bench = Bench(Watch::default());
    assert_eq!(bench.fresh(0.0), Err(Some(Cause::SteerLost)));
    assert_eq!(bench.fresh(0.01), Err(Some(Cause::SteerLost)));
    assert_eq!(bench.fresh(0.02), Ok((0.02, 0)));
}

/// Situation: believed. Action: no new sample. Must hold: the last one is held with its age, lost after the fifth period;
/// three good ones bring it back.
#[test]
fn late_is_held_then_lost() {
    let mut bench = Bench::trusted();
    for age in 1..=5 {
        assert_eq!(
            bench.step(7.0, age, false).value,
            Some(([1.002], age)),
            "the frame's held value is not read"
        );
    }
    assert_eq!(bench.step(7.0, 6, false), Told { value: None, lost: Some(Cause::SteerLost) });
    assert_eq!(bench.step(0.0, MISSING, false).lost, Some(Cause::SteerLost));
    // So long a gap allows so large a change, ...
    assert!(bench.fresh(1.1).is_err() && bench.fresh(1.1).is_err() && bench.fresh(1.1).is_ok());
}

/// Situation: believed. Action: a jump, again and again. Must hold: refusing it gives it no more time: refused until lost.
#[test]
fn a_jump_does_not_become_true_by_waiting() {
    let mut bench = Bench::trusted();
    for age in 1..=5 {
        assert_eq!(bench.fresh(1.25), Ok((1.002, age)), "0.1 a period, {age} periods");
    }
    assert_eq!(bench.fresh(1.25), Err(Some(Cause::SteerJump)));
    let stepping = Sensor { step: 0.2, ..SENSOR };
    let mut watch = bench.0;
    watch = (0..3).fold(watch, |mut watch, _| {
        watch.step(&stepping, &CODES, 1e-3, ([1.25], 0), false);
        watch
    });
    let told = watch.step(&stepping, &CODES, 1e-3, ([1.54], 0), false);
    assert_eq!(told.value, Some(([1.54], 0)), "a step of 0.2 and a period's slope");
}

/// Situation: believed. Action: samples that can't be, for as long as may be and longer. Must hold: the last good one is held,
/// then it is lost with the reason; a single one is forgotten.
#[test]
fn what_cannot_be_is_not_used() {
    for (bad, cause) in [
        (f32::NAN, Cause::SteerRange),
        (f32::INFINITY, Cause::SteerRange),
        (-10.001, Cause::SteerRange),
        (1.8, Cause::SteerJump),
    ] {
        let mut bench = Bench::trusted();
        assert_eq!(bench.fresh(bad), Ok((1.002, 1)), "{bad}");
        assert_eq!(bench.fresh(1.0), Ok((1.0, 0)), "{bad}: one is forgotten");
        for age in 1..=5 {
            assert_eq!(bench.fresh(bad), Ok((1.0, age)), "{bad}");
        }
        assert_eq!(bench.fresh(bad), Err(Some(cause)), "{bad}");
    }
    // At the limits themselves it is used.
    let mut bench = Bench::trusted();
    assert_eq!(bench.fresh(1.1), Ok((1.1, 0)));
    let mut bench = Bench(Watch::default());
    assert!([10.0; 3].map(|x| bench.fresh(x).is_ok())[2]);
}

/// Situation: believed; samples an eighth apart, by a sensor to which an eighth a period is allowed. Action: up, down, a hair more.
/// Must hold: exactly what is allowed is used, more is a jump.
#[test]
fn as_far_as_allowed_is_no_jump() {
    let sensor = Sensor { slope_per_s: Some(128.0), qualify_samples: 1, ..SENSOR };
    // So that the eighth is one to the bit.
    let period_s = 1.0 / 1024.0;
    let mut watch = Watch::<1>::default();
    let mut fresh = |value| watch.step(&sensor, &CODES, period_s, ([value], 0), false).value;
    for value in [1.0, 1.125, 1.25, 1.125, 1.0] {
        assert_eq!(fresh(value), Some(([value], 0)));
    }
    assert_eq!(fresh(1.125 + f32::EPSILON), Some(([1.0], 1)));
}

/// Situation: a sensor that jumped to another level and stays there. Action: wait. Must hold: lost, then believed again at
/// that level after three good ones, for it can't be told from the truth any more.
#[test]
fn a_new_level_must_prove_itself() {
    let mut bench = Bench::trusted();
    let answers: Vec<bool> = (0..12).map(|k| bench.fresh(5.0 + 1e-3 * k as f32).is_ok()).collect();
    assert_eq!(answers[..5], [true; 5]);
    let back = answers[5..].iter().position(|ok| *ok).expect("believed again");
    assert!((2..=4).contains(&back), "{answers:?}");
}

/// Situation: every new sample has the same bits. Action: with and without motion. Must hold: stuck after eight periods of
/// motion, never without; one other sample clears it.
#[test]
fn stuck_only_counts_while_something_moves() {
    let mut bench = Bench::trusted();
    for _ in 0..100 {
        assert!(bench.fresh(1.002).is_ok());
    }
    for k in 1..=20 {
        let told = bench.step(1.002, 0, true);
        assert_eq!(told.lost, (k >= 8).then_some(Cause::SteerStuck), "{k}");
    }
    assert!(bench.fresh(1.01).is_err() && bench.fresh(1.02).is_err() && bench.fresh(1.03).is_ok());
}

proptest! {
    /// Situation: any samples, ages and motion. Action: watch. Must hold: what is believed is finite, within range, no older
    /// than allowed, and no further from the one believed before than the slope allows over the time between.
    #[test]
    fn what_is_believed_is_believable(
        samples in proptest::collection::vec((any::<u32>(), -12.0_f32..12.0, 0_u16..8, any::<bool>(), 0..4_u8), 1..300)
    ) {
        let mut bench = Bench(Watch::default());
        let mut before: Option<f32> = None;
        for (bits, value, age, moves, kind) in samples {
            let value = if kind == 0 { f32::from_bits(bits) } else { value };
            let age = if kind < 3 { 0 } else { age };
            match bench.step(value, age, moves).value {
                None => before = None,
                Some(([v], age)) => {
                    prop_assert!(v.is_finite() && v.abs() <= 10.0 && age <= 5);
                    if let Some(b) = before {
                        prop_assert!((v - b).abs() <= 0.1 * 6.0 + 1e-5, "{b} {v}");
                    }
                    before = Some(v);
                }
            }
        }
    }
}
