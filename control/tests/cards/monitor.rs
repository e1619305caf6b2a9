//! The monitor of one sensor.

use control::sensors::frame::MISSING;
use control::sensors::monitor::{CheckedSample, SensorCauses, SensorMonitor, SensorPlan};
use control::{Cause, Loss, Sensor};
use proptest::prelude::*;

const CAUSES: SensorCauses = SensorCauses {
    lost: Cause::SteerLost,
    range: Cause::SteerRange,
    jump: Cause::SteerJump,
    stuck: Cause::SteerStuck,
};

/// Range 10, slope 100 per second (0.1 per period), timeout 5 periods, stuck after 8, qualified after 3 good samples.
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
    SensorPlan::new(sensor, CAUSES, 1e-3)
}

struct Bench(SensorMonitor<1>);

impl Bench {
    fn step(&mut self, value: f32, age: u16, moving: bool) -> CheckedSample<1> {
        self.0.step(&plan(&SENSOR), ([value], age), || moving)
    }

    /// A fresh sample: value and age if valid, else the cause.
    fn fresh(&mut self, value: f32) -> Result<(f32, u16), Option<Cause>> {
        let checked = self.step(value, 0, false);
        checked.value.map(|([v], age)| (v, age)).ok_or(checked.lost)
    }

    /// A qualified monitor whose last sample is 1.002.
    fn valid() -> Self {
        let mut bench = Self(SensorMonitor::default());
        for k in 0..3 {
            assert_eq!(bench.fresh(1.0 + 1e-3 * k as f32).is_ok(), k == 2, "{k}");
        }
        bench
    }
}

/// Situation: a sensor that is not fitted.
/// Action: arbitrary samples.
/// Must hold: never valid, never lost.
#[test]
fn a_sensor_that_is_not_fitted_is_never_lost() {
    let mut monitor = SensorMonitor::<1>::default();
    for k in 0..100 {
        let sensor = Sensor::default();
        let checked = monitor.step(&plan(&sensor), ([f32::NAN], k), || true);
        assert_eq!(checked, CheckedSample { value: None, lost: None });
    }
}

/// Situation: a monitor just started.
/// Action: good samples.
/// Must hold: valid from the third on, lost before.
#[test]
fn it_must_qualify() {
    let mut bench = Bench(SensorMonitor::default());
    assert_eq!(bench.fresh(0.0), Err(Some(Cause::SteerLost)));
    assert_eq!(bench.fresh(0.01), Err(Some(Cause::SteerLost)));
    assert_eq!(bench.fresh(0.02), Ok((0.02, 0)));
}

/// Situation: a valid sensor.
/// Action: no new samples, then good ones.
/// Must hold: the last sample is held with its age, lost after the fifth period; three good samples requalify it.
#[test]
fn a_late_sample_is_held_then_lost() {
    let mut bench = Bench::valid();
    for age in 1..=5 {
        assert_eq!(
            bench.step(7.0, age, false).value,
            Some(([1.002], age)),
            "the frame's held value is not read"
        );
    }
    assert_eq!(bench.step(7.0, 6, false), CheckedSample { value: None, lost: Some(Cause::SteerLost) });
    assert_eq!(bench.step(0.0, MISSING, false).lost, Some(Cause::SteerLost));
    // The gap allows this change.
    assert!(bench.fresh(1.1).is_err() && bench.fresh(1.1).is_err() && bench.fresh(1.1).is_ok());
}

/// Situation: a valid sensor.
/// Action: the same jump, repeated.
/// Must hold: rejections do not enlarge the accepted change: rejected until lost.
#[test]
fn a_repeated_jump_stays_rejected() {
    let mut bench = Bench::valid();
    for age in 1..=5 {
        assert_eq!(bench.fresh(1.25), Ok((1.002, age)), "0.1 a period, {age} periods");
    }
    assert_eq!(bench.fresh(1.25), Err(Some(Cause::SteerJump)));
    let stepping = Sensor { step: 0.2, ..SENSOR };
    let mut monitor = bench.0;
    monitor = (0..3).fold(monitor, |mut monitor, _| {
        monitor.step(&plan(&stepping), ([1.25], 0), || false);
        monitor
    });
    let checked = monitor.step(&plan(&stepping), ([1.54], 0), || false);
    assert_eq!(checked.value, Some(([1.54], 0)), "a step of 0.2 and a period's slope");
}

/// Situation: a valid sensor with a sampling period of 1 to 50 control periods and a timeout of 250.
/// Action: it jumps from 1 to 20 and stays there.
/// Must hold: at every sampling period it is held for about 250 periods, then lost with the jump as cause.
#[test]
fn a_jump_that_stays_has_the_same_cause_at_every_sampling_period() {
    for every in [1, 2, 5, 10, 20, 50_u16] {
        let sensor = Sensor { max: 30.0, timeout_ticks: 250, ..SENSOR };
        let mut monitor = SensorMonitor::<1>::default();
        let mut lost = None;
        for k in 0..1000_u16 {
            let (age, good_samples) = (k % every, k / every < 5);
            let value = if good_samples { 1.0 } else { 20.0 };
            let checked = monitor.step(&plan(&sensor), ([value], age), || false);
            let jumped = k - k.min(5 * every);
            if !good_samples && checked.value.is_none() && lost.is_none() {
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

/// Situation: a wheel that starts to turn, with a sample every 40 periods: 0, 2, 3, then rising by 0.1. Allowed are 0.1
/// per period; three good samples qualify.
/// Action: step.
/// Must hold: valid with the third to fifth sample: while the sensor is not valid, the time between samples counts.
#[test]
fn a_slow_sensor_qualifies_within_five_samples() {
    let sensor = Sensor { timeout_ticks: 250, ..SENSOR };
    let mut monitor = SensorMonitor::<1>::default();
    let mut valid_from = None;
    for k in 0..400_u16 {
        let (age, number) = (k % 40, k / 40);
        let value =
            [0.0, 2.0, 3.0].get(usize::from(number)).copied().unwrap_or(3.0 + 0.1 * f32::from(number));
        let checked = monitor.step(&plan(&sensor), ([value], age), || false);
        if checked.value.is_some() {
            valid_from.get_or_insert(number);
        }
    }
    assert!(valid_from.is_some_and(|number| (2..=4).contains(&number)), "{valid_from:?}");
}

/// Situation: a valid sensor.
/// Action: implausible samples, for the timeout and longer.
/// Must hold: the last good sample is held, then the sensor is lost with the cause; a single bad sample has no effect
/// later.
#[test]
fn implausible_samples_are_not_used() {
    for (bad, cause) in [
        (f32::NAN, Cause::SteerRange),
        (f32::INFINITY, Cause::SteerRange),
        (-10.001, Cause::SteerRange),
        (1.8, Cause::SteerJump),
    ] {
        let mut bench = Bench::valid();
        assert_eq!(bench.fresh(bad), Ok((1.002, 1)), "{bad}");
        assert_eq!(bench.fresh(1.0), Ok((1.0, 0)), "{bad}: a single one has no effect");
        for age in 1..=5 {
            assert_eq!(bench.fresh(bad), Ok((1.0, age)), "{bad}");
        }
        assert_eq!(bench.fresh(bad), Err(Some(cause)), "{bad}");
    }
    // Samples at the limits are used.
    let mut bench = Bench::valid();
    assert_eq!(bench.fresh(1.1), Ok((1.1, 0)));
    let mut bench = Bench(SensorMonitor::default());
    assert!([10.0; 3].map(|x| bench.fresh(x).is_ok())[2]);
}

/// Situation: a valid sensor with an allowed change of 1/8 per period.
/// Action: samples that rise and fall by 1/8, then by slightly more.
/// Must hold: exactly the allowed change is used, more is a jump.
#[test]
fn the_allowed_change_is_not_a_jump() {
    let sensor = Sensor { slope_per_s: Some(128.0), qualify_samples: 1, ..SENSOR };
    // A period of 1/1024 s makes the 1/8 exact.
    let plan = SensorPlan::new(&sensor, CAUSES, 1.0 / 1024.0);
    let mut monitor = SensorMonitor::<1>::default();
    let mut fresh = |value| monitor.step(&plan, ([value], 0), || false).value;
    for value in [1.0, 1.125, 1.25, 1.125, 1.0] {
        assert_eq!(fresh(value), Some(([value], 0)));
    }
    assert_eq!(fresh(1.125 + f32::EPSILON), Some(([1.0], 1)));
}

/// Situation: a sensor that jumped to another level and stays there.
/// Action: step.
/// Must hold: lost, then valid again at that level after three good samples, because it cannot be distinguished from
/// the true value.
#[test]
fn a_new_level_must_qualify() {
    let mut bench = Bench::valid();
    let valid_samples: Vec<bool> = (0..12).map(|k| bench.fresh(5.0 + 1e-3 * k as f32).is_ok()).collect();
    assert_eq!(valid_samples[..5], [true; 5]);
    let back = valid_samples[5..].iter().position(|ok| *ok).expect("valid again");
    assert!((2..=4).contains(&back), "{valid_samples:?}");
}

/// Situation: every new sample is the same.
/// Action: step with and without motion.
/// Must hold: stuck after eight periods of motion, never without; three different samples requalify it.
#[test]
fn stuck_counts_only_during_motion() {
    let mut bench = Bench::valid();
    for _ in 0..100 {
        assert!(bench.fresh(1.002).is_ok());
    }
    for k in 1..=20 {
        let checked = bench.step(1.002, 0, true);
        assert_eq!(checked.lost, (k >= 8).then_some(Cause::SteerStuck), "{k}");
    }
    assert!(bench.fresh(1.01).is_err() && bench.fresh(1.02).is_err() && bench.fresh(1.03).is_ok());
}

/// Situation: a sensor with a sample every fourth period.
/// Action: the same sample with motion in every other period, then others.
/// Must hold: the periods between samples count, so the sensor is stuck with the fourth equal sample; different samples
/// requalify it.
#[test]
fn motion_between_slow_samples_counts() {
    let mut bench = Bench::valid();
    let checked: Vec<_> = (0..24_u16).map(|k| bench.step(1.002, k % 4, k % 2 == 1).lost).collect();
    // Two periods of motion per sample: eight with the sample of period 16.
    let stuck: Vec<usize> = (0..24).filter(|k| checked[*k] == Some(Cause::SteerStuck)).collect();
    assert_eq!(stuck, (16..24).collect::<Vec<_>>());
    for k in 0..3_u8 {
        let checked = bench.step(1.05 + 0.05 * f32::from(k), 0, true);
        assert_eq!(checked.value.is_some(), k == 2, "{k}");
    }
}

/// Situation: a sensor that is always two periods late, and one with a sample every third period.
/// Action: step.
/// Must hold: each sample is used with its age, and its change is limited by the slope over the periods between, not
/// more.
#[test]
fn late_and_slow_samples_are_used() {
    let mut bench = Bench::valid();
    for k in 0..20_u8 {
        let value = 1.05 + 0.09 * f32::from(k % 2);
        assert_eq!(bench.step(value, 2, true).value, Some(([value], 2)), "{k}");
    }
    let mut bench = Bench::valid();
    for k in 0..20_u8 {
        let value = 1.0 + 0.29 * f32::from(k % 2);
        for age in 1..=2 {
            assert!(bench.step(value, age, true).value.is_some_and(|(_, checked)| checked == age));
        }
        assert_eq!(bench.step(value, 0, true).value, Some(([value], 0)), "{k}");
    }
    let (held, rejected) = (bench.0, 1.29 - 0.31);
    assert_eq!([1, 2, 0].map(|age| bench.step(rejected, age, true).value)[2], Some(([1.29], 3)));
    bench.0 = held;
    assert_eq!([1, 2, 3, 0].map(|age| bench.step(rejected, age, true).value)[3], Some(([rejected], 0)));
}

/// Reference monitor: the rules applied to each sample, without short path.
struct Reference {
    last: f32,
    allowed: f32,
    age: u16,
    reported_age: Option<u16>,
    good_samples: u16,
    unchanged: u16,
    valid: bool,
    reject_cause: Option<Cause>,
}

impl Reference {
    /// The last sample is zero, and any change is allowed.
    const START: Self = Self {
        last: 0.0,
        allowed: f32::INFINITY,
        age: 0,
        reported_age: None,
        good_samples: 0,
        unchanged: 0,
        valid: false,
        reject_cause: None,
    };

    fn step(&mut self, value: f32, age: u16, moving: bool) -> CheckedSample<1> {
        let slope = SENSOR.slope_per_s.map_or(f32::INFINITY, |slope| slope * 1e-3);
        let held = self.reported_age.is_some_and(|checked| age == checked + 1);
        (self.age, self.reported_age) = (self.age.saturating_add(1), (age != MISSING).then_some(age));
        let unchanged = self.unchanged + u16::from(moving);
        let jumps = (value - self.last).abs() > self.allowed;
        if held || age == MISSING {
            let more = if self.valid && self.reject_cause.is_some() { 0.0 } else { slope };
            (self.unchanged, self.allowed) = (unchanged, self.allowed + more);
        } else if value.is_nan() || value.abs() > SENSOR.max {
            (self.unchanged, self.good_samples, self.reject_cause) = (unchanged, 0, Some(CAUSES.range));
        } else if jumps && self.valid {
            (self.unchanged, self.good_samples, self.reject_cause) = (unchanged, 0, Some(CAUSES.jump));
        } else {
            self.unchanged = if self.last == value { unchanged } else { 0 };
            (self.good_samples, self.reject_cause) =
                if jumps { (0, Some(CAUSES.jump)) } else { (self.good_samples + 1, None) };
            (self.last, self.age, self.allowed) = (value, age, slope);
            if self.unchanged >= SENSOR.stuck_ticks {
                (self.good_samples, self.valid, self.reject_cause) = (0, false, Some(CAUSES.stuck));
            }
        }
        if self.age > SENSOR.timeout_ticks {
            (self.good_samples, self.valid) = (0, false);
        }
        self.valid |= self.good_samples >= SENSOR.qualify_samples;
        let lost = (!self.valid).then_some(self.reject_cause.unwrap_or(CAUSES.lost));
        CheckedSample { value: self.valid.then_some(([self.last], self.age)), lost }
    }
}

proptest! {
    /// Situation: samples of every kind: fresh, late, held, missing, equal, out of range, with motion and without.
    /// Action: step monitor and reference.
    /// Must hold: the same results.
    #[test]
    fn the_short_path_agrees_with_the_rules(
        samples in proptest::collection::vec((0_u8..16, -1.0_f32..1.0, 0_u16..8, any::<bool>()), 1..400)
    ) {
        let (mut bench, mut reference) = (Bench(SensorMonitor::default()), Reference::START);
        let (mut value, mut age) = (0.0, 0);
        for (kind, by, late, moving) in samples {
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
            prop_assert_eq!(bench.step(value, reported_age, moving), reference.step(value, reported_age, moving));
            value = if value.abs() <= 10.0 { value } else { 0.0 };
        }
    }

    /// Situation: arbitrary samples, ages and motion.
    /// Action: step.
    /// Must hold: a valid value is finite, within range, within the timeout, and no further from the previous valid one
    /// than the slope allows over the time between.
    #[test]
    fn valid_values_are_plausible(
        samples in proptest::collection::vec((any::<u32>(), -12.0_f32..12.0, 0_u16..8, any::<bool>(), 0..4_u8), 1..300)
    ) {
        let mut bench = Bench(SensorMonitor::default());
        let mut before: Option<f32> = None;
        for (bits, value, age, moving, kind) in samples {
            let value = if kind == 0 { f32::from_bits(bits) } else { value };
            let age = if kind < 3 { 0 } else { age };
            match bench.step(value, age, moving).value {
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
