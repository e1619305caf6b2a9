//! Bounds of the wheel speeds over their newest samples.

use crate::validation::{bare, step};
use control::sensors::measurements::SpeedInterval;
use control::sensors::validation::{MAX_RECENT_SAMPLES, ValidationState};
use control::{Sample, Sensor, SensorFrame, ValidationConfig};

/// Both wheels fitted: bounds over three samples, widening at 10 m/s^2 above an age of 4 periods, lost after 20.
fn wheels() -> ValidationConfig {
    let wheel = Sensor { timeout_ticks: 20, ..Sensor::exact(30.0) };
    ValidationConfig {
        recent_samples: 3,
        drift_m_s2: 10.0,
        drift_after_ticks: 4,
        front_wheel: wheel,
        rear_wheel: wheel,
        ..bare()
    }
}

/// Situation: a wheel's samples rise, fall, stop, return.
/// Action: step.
/// Must hold: the bounds span the newest three; they widen in both directions above the declared age, not up to it;
/// there are none while the sensor is lost, and older samples do not count afterwards. The other wheel's bounds are
/// independent.
#[test]
fn the_speed_lies_between_the_recent_samples() {
    let config = wheels();
    let mut state = ValidationState::default();
    let mut at = |front, rear| {
        let frame = SensorFrame { front_wheel_m_s: front, rear_wheel_m_s: rear, ..SensorFrame::missing() };
        let checked = step(&config, &mut state, &frame, 0.0);
        (checked.front_wheel_m_s(), checked.rear_wheel_m_s())
    };
    let steady = Some(SpeedInterval { low: 7.0, newest: 7.0, high: 7.0 });
    for (speed, low, high) in [
        (4.0, 4.0, 4.0),
        (5.0, 4.0, 5.0),
        (6.0, 4.0, 6.0),
        (5.5, 5.0, 6.0),
        (5.0, 5.0, 6.0),
        (4.5, 4.5, 5.5),
        (5.0, 4.5, 5.0),
    ] {
        let bounds = Some(SpeedInterval { low, newest: speed, high });
        assert_eq!(at(Sample::fresh(speed), Sample::fresh(7.0)), (bounds, steady));
    }
    for age_ticks in 1..=20 {
        let (front, rear) = at(Sample { value: 5.0, age_ticks }, Sample::fresh(7.0));
        let drift = 0.01 * f32::from(age_ticks.saturating_sub(4));
        let front = front.expect("held");
        let near = |a: f32, b: f32| (a - b).abs() < 1e-6;
        assert!(near(front.low, 4.5 - drift) && near(front.high, 5.0 + drift), "{age_ticks}: {front:?}");
        assert_eq!((front.newest, rear), (5.0, steady));
        // Up to the declared age the bounds are unchanged to the bit.
        assert!(age_ticks > 4 || (front.low, front.high) == (4.5, 5.0));
    }
    assert_eq!(at(Sample { value: 5.0, age_ticks: 21 }, Sample::fresh(7.0)), (None, steady));
    let restarted = SpeedInterval { low: 9.0, newest: 9.0, high: 9.0 };
    assert_eq!(at(Sample::fresh(9.0), Sample::fresh(7.0)), (Some(restarted), steady));
}

/// Situation: a wheel whose samples are never fresh, as behind a slow link.
/// Action: step.
/// Must hold: the bounds start at the first sample, not at zero.
#[test]
fn a_late_first_sample_has_bounds() {
    let config = ValidationConfig { drift_m_s2: 0.0, ..wheels() };
    let mut state = ValidationState::default();
    let frame =
        SensorFrame { front_wheel_m_s: Sample { value: 5.0, age_ticks: 1 }, ..SensorFrame::missing() };
    let checked = step(&config, &mut state, &frame, 0.0);
    assert_eq!(checked.front_wheel_m_s(), Some(SpeedInterval { low: 5.0, newest: 5.0, high: 5.0 }));
}

/// Situation: a wheel whose samples come two periods late, and one whose samples, each held for three periods, are
/// never fresh.
/// Action: step over rising speeds.
/// Must hold: bounds over the newest three samples in both cases.
#[test]
fn samples_that_are_never_fresh_all_count() {
    let config = ValidationConfig { drift_m_s2: 0.0, ..wheels() };
    let mut state = ValidationState::default();
    for k in 0_u16..30 {
        let (late, slow) = (f32::from(k), f32::from(k / 3));
        let frame = SensorFrame {
            front_wheel_m_s: Sample { value: late, age_ticks: 2 },
            rear_wheel_m_s: Sample { value: slow, age_ticks: 1 + k % 3 },
            ..SensorFrame::missing()
        };
        let checked = step(&config, &mut state, &frame, 0.0);
        let bounds = |newest: f32| Some(SpeedInterval { low: (newest - 2.0).max(0.0), newest, high: newest });
        assert_eq!(
            (checked.front_wheel_m_s(), checked.rear_wheel_m_s()),
            (bounds(late), bounds(slow)),
            "{k}"
        );
    }
}

/// Situation: each number of samples that can be declared.
/// Action: step over rising speeds.
/// Must hold: bounds over exactly that number.
#[test]
fn the_bounds_span_as_many_samples_as_declared() {
    for count in 1..=MAX_RECENT_SAMPLES as u16 {
        let config = ValidationConfig { recent_samples: count, ..wheels() };
        let mut state = ValidationState::default();
        for k in 0_u16..20 {
            let speed = f32::from(k);
            let frame = SensorFrame { front_wheel_m_s: Sample::fresh(speed), ..SensorFrame::missing() };
            let checked = step(&config, &mut state, &frame, 0.0).front_wheel_m_s().expect("fresh");
            assert_eq!(
                (checked.low, checked.high),
                (f32::from(k.saturating_sub(count - 1)), speed),
                "{count}"
            );
        }
    }
}

/// Situation: two intervals.
/// Action: scale and span.
/// Must hold: ends scaled and joined; the newest sample is that of the first.
#[test]
fn bounds_are_scaled_and_joined() {
    let a = SpeedInterval { low: 2.0, newest: 3.0, high: 5.0 };
    assert_eq!(a.scaled(4.0), SpeedInterval { low: 8.0, newest: 12.0, high: 20.0 });
    for (low, high) in [(2.5, 4.0), (1.0, 4.0), (2.5, 6.0), (1.0, 6.0)] {
        let b = SpeedInterval { low, newest: 3.5, high };
        let both = SpeedInterval { low: f32::min(low, 2.0), newest: 3.0, high: f32::max(high, 5.0) };
        assert_eq!(a.spanning(b), both);
        assert_eq!(b.spanning(a), SpeedInterval { newest: 3.5, ..both });
    }
}
