//! Flight cards: one sensor watched.

use control::sensors::frame::MISSING;
use control::sensors::monitor::{CheckedSample, SensorCauses, SensorMonitor, SensorPlan};
use control::{Cause, Loss, Sensor};
use proptest::prelude::*;

const CODES: SensorCauses = SensorCauses {
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

/// At 1 kHz.
fn plan(sensor: &Sensor) -> SensorPlan {
    SensorPlan::new(sensor, CODES, 1e-3)
}

struct Bench(SensorMonitor<1>);

impl Bench {
    fn step(&mut self, value: f32, age: u16, moves: bool) -> CheckedSample<1> {
        self.0.step(&plan(&SENSOR), ([value], age), || moves)
    }

    /// A fresh sample: what is believed of it, or why it is not.
    fn fresh(&mut self, value: f32) -> Result<(f32, u16), Option<Cause>> {
        let checked = self.step(value, 0, false);
        checked.value.map(|([v], age)| (v, age)).ok_or(checked.lost)
    }

    /// Believed, the last sample 1.0.
    fn trusted() -> Self {
        let mut bench = Self(SensorMonitor::default());
        for k in 0..3 {
            assert_eq!(bench.fresh(1.0 + 1e-3 * k as f32).is_ok(), k == 2, "{k}");
        }
        bench
    }
}

/// Situation: a sensor that is not fitted. Action: any sample. Must hold: never believed, never lost.
#[test]
fn what_is_not_there_is_not_missed() {
    let mut watch = SensorMonitor::<1>::default();
    for k in 0..100 {
        let sensor = Sensor::default();
        let checked = watch.step(&plan(&sensor), ([f32::NAN], k), || true);
        assert_eq!(checked, CheckedSample { value: None, lost: None });
    }
}

/// Situation: just started. Action: good samples. Must hold: believed from the third on, lost before.
#[test]
fn it_must_prove_itself() {
    let mut bench = Bench(SensorMonitor::default());
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
    assert_eq!(bench.step(7.0, 6, false), CheckedSample { value: None, lost: Some(Cause::SteerLost) });
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
        watch.step(&plan(&stepping), ([1.25], 0), || false);
        watch
    });
    let checked = watch.step(&plan(&stepping), ([1.54], 0), || false);
    assert_eq!(checked.value, Some(([1.54], 0)), "a step of 0.2 and a period's slope");
}

/// Situation: a sensor with a sample every so many periods, from 1 to 50, believed; 250 periods are too late. Action: it jumps
/// from 1 to 20 for good. Must hold: whatever the sampling period it is held for 250 periods, then lost by the jump.
#[test]
fn a_jump_that_stays_has_the_same_cause_at_every_sampling_period() {
    for every in [1, 2, 5, 10, 20, 50_u16] {
        let sensor = Sensor { max: 30.0, timeout_ticks: 250, ..SENSOR };
        let mut watch = SensorMonitor::<1>::default();
        let mut lost = None;
        for k in 0..1000_u16 {
            let (age, good) = (k % every, k / every < 5);
            let value = if good { 1.0 } else { 20.0 };
            let checked = watch.step(&plan(&sensor), ([value], age), || false);
            let jumped = k - k.min(5 * every);
            if !good && checked.value.is_none() && lost.is_none() {
                lost = Some((jumped + every, checked.lost));
            }
            assert!(
                lost.is_some() || checked.value.is_none_or(|(value, _)| value == [1.0]),
                "{every} {k}: {checked:?}"
            );
        }
        let (after, cause) = lost.expect("lost at last");
        assert_eq!(cause, Some(Cause::SteerJump), "every {every}");
        assert!((250..=252 + every).contains(&after), "every {every}: after {after}");
    }
}

/// Situation: a wheel that begins to turn, a sample every 40 periods: 0, then 2, 3, 3.1 and so on by a tenth, where 0.1 a period may come and three good ones are
/// needed. Action: wait. Must hold: believed with the fourth or fifth sample: while it is not believed, time between samples counts.
#[test]
fn a_slow_sensor_that_begins_to_speak_is_believed_soon() {
    let sensor = Sensor { timeout_ticks: 250, ..SENSOR };
    let mut watch = SensorMonitor::<1>::default();
    let mut believed = None;
    for k in 0..400_u16 {
        let (age, number) = (k % 40, k / 40);
        let value =
            [0.0, 2.0, 3.0].get(usize::from(number)).copied().unwrap_or(3.0 + 0.1 * f32::from(number));
        let checked = watch.step(&plan(&sensor), ([value], age), || false);
        if checked.value.is_some() {
            believed.get_or_insert(number);
        }
    }
    assert!(believed.is_some_and(|number| (2..=4).contains(&number)), "{believed:?}");
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
    let mut bench = Bench(SensorMonitor::default());
    assert!([10.0; 3].map(|x| bench.fresh(x).is_ok())[2]);
}

/// Situation: believed; samples an eighth apart, by a sensor to which an eighth a period is allowed. Action: up, down, a hair more.
/// Must hold: exactly what is allowed is used, more is a jump.
#[test]
fn as_far_as_allowed_is_no_jump() {
    let sensor = Sensor { slope_per_s: Some(128.0), qualify_samples: 1, ..SENSOR };
    // So that the eighth is one to the bit.
    let plan = SensorPlan::new(&sensor, CODES, 1.0 / 1024.0);
    let mut watch = SensorMonitor::<1>::default();
    let mut fresh = |value| watch.step(&plan, ([value], 0), || false).value;
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

/// Situation: every new sample is the same. Action: with and without motion. Must hold: stuck after eight periods of
/// motion, never without; one other sample clears it.
#[test]
fn stuck_only_counts_while_something_moves() {
    let mut bench = Bench::trusted();
    for _ in 0..100 {
        assert!(bench.fresh(1.002).is_ok());
    }
    for k in 1..=20 {
        let checked = bench.step(1.002, 0, true);
        assert_eq!(checked.lost, (k >= 8).then_some(Cause::SteerStuck), "{k}");
    }
    assert!(bench.fresh(1.01).is_err() && bench.fresh(1.02).is_err() && bench.fresh(1.03).is_ok());
}

/// Situation: a sensor that brings a sample every fourth period. Action: the same sample with motion in every other
/// period, then others. Must hold: the periods between count, so it is stuck with the fourth equal sample; another one clears it.
#[test]
fn a_slow_sensor_is_stuck_by_what_moved_between_its_samples() {
    let mut bench = Bench::trusted();
    let checked: Vec<_> = (0..24_u16).map(|k| bench.step(1.002, k % 4, k % 2 == 1).lost).collect();
    // Two moves are over with each sample: eight with the one of period 16.
    let stuck: Vec<usize> = (0..24).filter(|k| checked[*k] == Some(Cause::SteerStuck)).collect();
    assert_eq!(stuck, (16..24).collect::<Vec<_>>());
    for k in 0..3_u8 {
        let checked = bench.step(1.05 + 0.05 * f32::from(k), 0, true);
        assert_eq!(checked.value.is_some(), k == 2, "{k}");
    }
}

/// Situation: a sensor that is always two periods late, and one that brings a sample every third period. Action: step.
/// Must hold: each sample is used with its age, and allowed to differ by as many periods' slope as lie between, not more.
#[test]
fn late_and_slow_samples_are_used() {
    let mut bench = Bench::trusted();
    for k in 0..20_u8 {
        let value = 1.05 + 0.09 * f32::from(k % 2);
        assert_eq!(bench.step(value, 2, true).value, Some(([value], 2)), "{k}");
    }
    let mut bench = Bench::trusted();
    for k in 0..20_u8 {
        let value = 1.0 + 0.29 * f32::from(k % 2);
        for age in 1..=2 {
            assert!(bench.step(value, age, true).value.is_some_and(|(_, checked)| checked == age));
        }
        assert_eq!(bench.step(value, 0, true).value, Some(([value], 0)), "{k}");
    }
    let (held, refused) = (bench.0, 1.29 - 0.31);
    assert_eq!([1, 2, 0].map(|age| bench.step(refused, age, true).value)[2], Some(([1.29], 3)));
    bench.0 = held;
    assert_eq!([1, 2, 3, 0].map(|age| bench.step(refused, age, true).value)[3], Some(([refused], 0)));
}

/// What a watch is to say, worked out anew for each sample and in one way only.
struct Plain {
    last: f32,
    allowed: f32,
    age: u16,
    reported_age: Option<u16>,
    good: u16,
    still: u16,
    trusted: bool,
    doubt: Option<Cause>,
}

impl Plain {
    /// As if zero had been the last sample, from which any change is allowed.
    const START: Self = Self {
        last: 0.0,
        allowed: f32::INFINITY,
        age: 0,
        reported_age: None,
        good: 0,
        still: 0,
        trusted: false,
        doubt: None,
    };

    fn step(&mut self, value: f32, age: u16, moves: bool) -> CheckedSample<1> {
        let slope = SENSOR.slope_per_s.map_or(f32::INFINITY, |slope| slope * 1e-3);
        let held = self.reported_age.is_some_and(|checked| age == checked + 1);
        (self.age, self.reported_age) = (self.age.saturating_add(1), (age != MISSING).then_some(age));
        let still = self.still + u16::from(moves);
        let jumps = (value - self.last).abs() > self.allowed;
        if held || age == MISSING {
            let more = if self.trusted && self.doubt.is_some() { 0.0 } else { slope };
            (self.still, self.allowed) = (still, self.allowed + more);
        } else if value.is_nan() || value.abs() > SENSOR.max {
            (self.still, self.good, self.doubt) = (still, 0, Some(CODES.range));
        } else if jumps && self.trusted {
            (self.still, self.good, self.doubt) = (still, 0, Some(CODES.jump));
        } else {
            self.still = if self.last == value { still } else { 0 };
            (self.good, self.doubt) = if jumps { (0, Some(CODES.jump)) } else { (self.good + 1, None) };
            (self.last, self.age, self.allowed) = (value, age, slope);
            if self.still >= SENSOR.stuck_ticks {
                (self.good, self.trusted, self.doubt) = (0, false, Some(CODES.stuck));
            }
        }
        if self.age > SENSOR.timeout_ticks {
            (self.good, self.trusted) = (0, false);
        }
        self.trusted |= self.good >= SENSOR.qualify_samples;
        let lost = (!self.trusted).then_some(self.doubt.unwrap_or(CODES.lost));
        CheckedSample { value: self.trusted.then_some(([self.last], self.age)), lost }
    }
}

proptest! {
    /// Situation: samples of every kind, now fresh, now late, held, missing, equal, out of range, with motion and without.
    /// Action: watch. Must hold: what is said is what the rules say, worked out one by one.
    #[test]
    fn the_short_way_says_what_the_long_one_says(
        samples in proptest::collection::vec((0_u8..16, -1.0_f32..1.0, 0_u16..8, any::<bool>()), 1..400)
    ) {
        let (mut bench, mut plain) = (Bench(SensorMonitor::default()), Plain::START);
        let (mut value, mut age) = (0.0, 0);
        for (kind, by, late, moves) in samples {
            (value, age) = match kind {
                0..=5 => (value + 0.12 * by, 0),
                6 | 7 => (value, 0),
                8..=11 => (value, age + 1),
                12 => (value + 0.2 * by, late),
                13 => (value + by, 0),
                14 => (12.0 * by, 0),
                _ => (f32::NAN, 0),
            };
            let reported_age = if kind == 8 { MISSING } else { age };
            prop_assert_eq!(bench.step(value, reported_age, moves), plain.step(value, reported_age, moves));
            value = if value.abs() <= 10.0 { value } else { 0.0 };
        }
    }

    /// Situation: any samples, ages and motion. Action: watch. Must hold: what is believed is finite, within range, no older
    /// than allowed, and no further from the one believed before than the slope allows over the time between.
    #[test]
    fn what_is_believed_is_believable(
        samples in proptest::collection::vec((any::<u32>(), -12.0_f32..12.0, 0_u16..8, any::<bool>(), 0..4_u8), 1..300)
    ) {
        let mut bench = Bench(SensorMonitor::default());
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
