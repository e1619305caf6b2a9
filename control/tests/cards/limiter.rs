//! The limiter keeps the torque inside every limit, acts only where a limit is reached, and is odd.

use crate::limits::{at_speed, calls, mirrored, plain, tables};
use control::safety::limiter::{LimiterPlan, LimiterState, TorqueRequest, step};
use control::safety::limits::*;
use proptest::prelude::*;

/// Limited torques of a sequence of requests, with the active limits.
fn limited(table: &Limits, rate_hz: f32, sequence: &[TorqueRequest]) -> Vec<(f32, ActiveLimits)> {
    let plan = LimiterPlan::new(table, rate_hz);
    let mut state = LimiterState::default();
    sequence.iter().map(|request| step(table, &plan, &mut state, request)).collect()
}

/// The torque after 3 s of the same request, once per millisecond.
fn held(table: &Limits, request: &TorqueRequest) -> (f32, ActiveLimits) {
    *limited(table, 1000.0, &vec![*request; 3000]).last().expect("not empty")
}

proptest! {
    /// Situation: arbitrary limits, call rate and sequence of calls, including NaN and jumps.
    /// Action: limit.
    /// Must hold: finite; the largest torque is never exceeded; where no limit is active the request passes unchanged
    /// to the bit.
    #[test]
    fn the_torque_is_finite_and_unchanged_where_no_limit_is_active(
        (table, rate_hz) in tables(), sequence in calls(1..200),
    ) {
        for (request, (torque, active)) in sequence.iter().zip(limited(&table, rate_hz, &sequence)) {
            prop_assert!(torque.is_finite());
            prop_assert!(table.max_torque_nm.is_none_or(|max| torque.abs() <= max), "{torque}");
            if active.is_empty() && request.wanted_nm.is_finite() && request.wanted_nm != 0.0 {
                prop_assert_eq!(torque.to_bits(), request.wanted_nm.to_bits());
            }
        }
    }

    /// Situation: arbitrary limits and calls, and their mirror image.
    /// Action: limit both.
    /// Must hold: the mirrored torque, to the bit, with the same active limits.
    #[test]
    fn the_mirrored_request_gives_the_mirrored_torque((table, rate_hz) in tables(), sequence in calls(1..200)) {
        let reflected: Vec<TorqueRequest> = sequence.iter().map(mirrored).collect();
        for (a, b) in limited(&table, rate_hz, &sequence).into_iter().zip(limited(&table, rate_hz, &reflected)) {
            prop_assert_eq!((a.0, a.1), (-b.0, b.1));
        }
    }

    /// Situation: a largest torque, one rate for both directions and a taper, any of them off; requests within the
    /// largest torque.
    /// Action: limit.
    /// Must hold: the bits of taper, clamp, clamp, with which the published product rides were computed.
    #[test]
    fn the_three_plain_limits_are_two_clamps(
        max in proptest::option::of(0.1_f32..50.0),
        rate in proptest::option::of(1.0_f32..1e5),
        taper in proptest::option::of((0.0_f32..4.0, 0.2_f32..5.0)),
        sequence in proptest::collection::vec((-80.0_f32..80.0, 0.0_f32..10.0), 1..200),
    ) {
        let taper = taper.map(|(zero_m_s, width)| Taper { zero_m_s, full_m_s: zero_m_s + width });
        let table = Limits { max_torque_nm: max, rise_nm_s: rate, fall_nm_s: rate, taper, ..Limits::default() };
        let plan = LimiterPlan::new(&table, 1000.0);
        let (mut state, mut last) = (LimiterState::default(), 0.0_f32);
        for (requested_nm, speed) in sequence {
            let scale = taper.map_or(1.0, |t| {
                if speed >= t.full_m_s { 1.0 }
                else if speed <= t.zero_m_s { 0.0 }
                else { (speed - t.zero_m_s) / (t.full_m_s - t.zero_m_s) }
            });
            // Below full speed the largest torque is tapered too, so only smaller requests agree.
            let requested_nm = if scale < 1.0 { max.map_or(requested_nm, |m| requested_nm.clamp(-m, m)) } else { requested_nm };
            let (torque, _) = step(&table, &plan, &mut state, &at_speed(requested_nm, speed));
            let mut expected = requested_nm * scale;
            if let Some(max) = max {
                expected = expected.clamp(-max, max);
            }
            if let Some(rate) = rate {
                expected = expected.clamp(last - rate / 1000.0, last + rate / 1000.0);
            }
            last = expected;
            prop_assert_eq!(torque.to_bits(), expected.to_bits());
        }
    }
}

/// Situation: each limit alone, with a request of 10 N m that it limits.
/// Action: hold the request.
/// Must hold: the torque of the limit's definition, and only that limit is active.
#[test]
fn each_limit_acts_as_defined() {
    use ActiveLimits as A;
    let off = Limits::default;
    let seven = Limits { max_torque_nm: Some(7.0), ..off() };
    let cap = SpeedCap { speed_m_s: [1.0, 2.0, 4.0, 8.0], torque_nm: [9.0, 8.0, 4.0, 6.0] };
    let cap = Limits { speed_cap: Some(cap), ..off() };
    let taper = Limits { taper: Some(Taper { zero_m_s: 1.0, full_m_s: 5.0 }), ..off() };
    let rider = Limits {
        rider_torque: Some(RiderTorque { allowance_nm: 1.0, multiplier: 2.0 }),
        max_torque_nm: Some(20.0),
        ..off()
    };
    let turned = RiderMotion { steer_rate_rad_s: 1.0, after_ms: 100, fade_ms: 50 };
    let turned = Limits { rider_motion: Some(turned), ..off() };
    let stop = Limits { end_stop: Some(EndStop { soft_rad: 0.5, hard_rad: 1.5 }), ..off() };
    let limp = Limits { max_torque_nm: Some(20.0), limp_fraction: Some(0.25), ..off() };
    let window = Limits { window: Some(Window { ms: 5000, nm: 3.0 }), ..off() };
    let ten = at_speed(10.0, 3.0);
    let steered = |steer| TorqueRequest { steer_rad: Some(steer), ..ten };
    let pushed = |torque| TorqueRequest { rider_torque_nm: Some(torque), ..ten };
    let between = |speed_low_m_s, speed_high_m_s| TorqueRequest { speed_low_m_s, speed_high_m_s, ..ten };
    let none = A::default();
    for (name, table, request, torque, active) in [
        ("off", off(), ten, 10.0, none),
        ("largest", seven, ten, 7.0, A::MAGNITUDE),
        ("cap between points", cap, ten, 6.0, A::SPEED),
        ("cap below the points", cap, at_speed(10.0, 0.0), 9.0, A::SPEED),
        ("cap above the points", cap, at_speed(10.0, 9.0), 6.0, A::SPEED),
        ("cap's least inside", cap, between(1.0, 8.0), 4.0, A::SPEED),
        ("cap, ends the other way round", cap, between(3.0, 2.0), 6.0, A::SPEED),
        ("cap, speed unknown", cap, at_speed(10.0, f32::NAN), 4.0, A::SPEED),
        ("taper", taper, ten, 5.0, A::TAPER),
        ("taper by the lowest", taper, between(2.0, 9.0), 2.5, A::TAPER),
        ("taper, speed unknown", taper, at_speed(10.0, f32::NAN), 0.0, A::TAPER),
        ("rider pushes along", rider, pushed(30.0), 10.0, none),
        ("rider allowed", rider, pushed(-6.0), 10.0, none),
        ("rider against", rider, pushed(-7.0), 8.0, A::RIDER_TORQUE),
        ("rider takes it all", rider, pushed(-30.0), 0.0, A::RIDER_TORQUE),
        ("turned along", turned, TorqueRequest { steer_rate_rad_s: Some(9.0), ..ten }, 10.0, none),
        ("turned slowly", turned, TorqueRequest { steer_rate_rad_s: Some(-0.9), ..ten }, 10.0, none),
        ("soft stop", stop, steered(1.25), 2.5, A::END_STOP),
        ("hard stop", stop, steered(2.0), 0.0, A::END_STOP),
        ("away from the stop", stop, steered(-2.0), 10.0, none),
        ("limp", limp, TorqueRequest { limp: true, ..ten }, 5.0, A::LIMP),
        ("not limping", limp, ten, 10.0, none),
        ("authority", off(), TorqueRequest { authority: 0.3, ..ten }, 3.0, A::AUTHORITY),
        ("authority unknown", off(), TorqueRequest { authority: f32::NAN, ..ten }, 0.0, A::AUTHORITY),
    ] {
        let (got, by) = held(&table, &request);
        assert!((got - torque).abs() < 1e-5 && by == active, "{name}: {got} {by:?}");
    }
    let started = limited(&window, 1000.0, &[ten; 4000]);
    assert!(started.iter().all(|s| *s == (3.0, A::WINDOW)));
    // Turned against for 125 ms: halfway through the fade. Then no torque, except for one step.
    let against = TorqueRequest { steer_rate_rad_s: Some(-2.0), ..ten };
    let faded = limited(&turned, 1000.0, &vec![against; 1000]);
    assert_eq!(faded[90], (10.0, none));
    assert!((faded[125].0 - 5.0).abs() < 0.21 && faded[125].1 == A::RIDER_MOTION, "{:?}", faded[125]);
    assert!(faded[200..].iter().all(|s| s.0.abs() < 0.21 && s.1 == A::RIDER_MOTION));
}

/// Situation: the handlebar turns against the torque at exactly the allowed rate, either way.
/// Action: hold the request.
/// Must hold: not limited at any time.
#[test]
fn turning_at_the_allowed_rate_is_not_an_override() {
    let rider_motion = RiderMotion { steer_rate_rad_s: 1.0, after_ms: 20, fade_ms: 10 };
    let table = Limits { rider_motion: Some(rider_motion), ..Limits::default() };
    for torque in [5.0_f32, -5.0] {
        let turned = TorqueRequest { steer_rate_rad_s: Some(-torque.signum()), ..at_speed(torque, 5.0) };
        assert!(
            limited(&table, 1000.0, &vec![turned; 1000])
                .iter()
                .all(|s| *s == (torque, ActiveLimits::default()))
        );
    }
}

/// Situation: rise at 100, fall at 1000 N m/s, 1 kHz.
/// Action: up, to the other side, back, and calls that come too early.
/// Must hold: each direction's rate; the rest of a step after zero is used for the rise; no more change than the
/// elapsed time allows.
#[test]
fn rise_and_fall_have_their_own_rates() {
    let table = Limits { rise_nm_s: Some(100.0), fall_nm_s: Some(1000.0), ..Limits::default() };
    let request = |wanted_nm, elapsed_us| TorqueRequest { wanted_nm, elapsed_us, ..plain() };
    let mut sequence = vec![request(5.0, 1000); 25];
    sequence.extend([request(-5.0, 1000); 3]);
    sequence.extend([
        request(-5.0, 100),
        request(-5.0, 0),
        request(-5.0, u32::MAX),
        request(0.0, 100),
        request(0.0, 1000),
    ]);
    let torques = limited(&table, 1000.0, &sequence);
    let near = |i: usize, torque: f32| assert!((torques[i].0 - torque).abs() < 1e-5, "{i}: {:?}", torques[i]);
    near(0, 0.1);
    near(24, 2.5);
    near(25, 1.5);
    near(26, 0.5);
    // Half the period to zero, half of it to the left.
    near(27, -0.05);
    near(28, -0.06);
    near(29, -0.06);
    near(30, -0.16);
    near(31, -0.06);
    near(32, 0.0);
}

/// Situation: no rate limit, 2 N m per 100 ms window; calls every 0.1, 1 and 10 ms.
/// Action: request 50 N m for 1 s.
/// Must hold: about the same torque at the same time at every call rate: never more than 2 N m of change in any 100 ms,
/// and at least 2 N m in every 125 ms.
#[test]
fn the_window_is_real_time() {
    let table = Limits { window: Some(Window { ms: 100, nm: 2.0 }), ..Limits::default() };
    for elapsed_us in [100, 1000, 10_000] {
        let request = TorqueRequest { wanted_nm: 50.0, elapsed_us, ..plain() };
        let calls = 1_000_000 / elapsed_us as usize;
        let torques = limited(&table, 1e6 / elapsed_us as f32, &vec![request; calls]);
        for (reach, bound) in [(100_000, 0.0..2.0001), (125_000, 1.9999..4.0001)] {
            let back = reach / elapsed_us as usize;
            for pair in torques.windows(back + 1) {
                let moved = pair[back].0 - pair[0].0;
                assert!(bound.contains(&moved), "{elapsed_us} us: {moved} in {reach} us");
            }
        }
        // The way to zero does not count against the window.
        let mut sequence = vec![request; calls];
        sequence.push(TorqueRequest { wanted_nm: -50.0, ..request });
        let last = *limited(&table, 1e6 / elapsed_us as f32, &sequence).last().expect("not empty");
        assert_eq!(last, (-2.0, ActiveLimits::WINDOW));
    }
}

/// Situation: each limit out of its range or order.
/// Action: validate.
/// Must hold: rejected with its name.
#[test]
fn limits_out_of_range_are_rejected_by_name() {
    let product = Limits::product();
    assert_eq!(product.validate(), Ok(()));
    assert_eq!(Limits::default().validate(), Ok(()));
    let rejected = |change: fn(&mut Limits)| {
        let mut table = product;
        change(&mut table);
        table.validate().expect_err("out of range").to_string()
    };
    for (message, name) in [
        (rejected(|l| l.max_torque_nm = Some(0.0)), "limits.max_torque_nm = 0 is outside 0.1 to 50"),
        (rejected(|l| l.rise_nm_s = Some(f32::NAN)), "limits.rise_nm_s = NaN is outside"),
        (rejected(|l| l.fall_nm_s = Some(0.5)), "limits.fall_nm_s = 0.5 is outside 1 to 100000"),
        (
            rejected(|l| l.taper = Some(Taper { zero_m_s: 2.0, full_m_s: 1.0 })),
            "limits.taper.full_m_s = 1 is outside 2.1",
        ),
        (
            rejected(|l| l.end_stop = Some(EndStop { soft_rad: 1.0, hard_rad: 1.0 })),
            "limits.end_stop.hard_rad = 1 is outside 1.01",
        ),
        (
            rejected(|l| {
                l.speed_cap = Some(SpeedCap { speed_m_s: [1.0, 3.0, 2.0, 4.0], torque_nm: [1.0; 4] })
            }),
            "limits.speed_cap.speed_3_m_s = 2 is outside 3.1 to 30",
        ),
        (
            rejected(|l| {
                l.speed_cap = Some(SpeedCap { torque_nm: [1.0, -1.0, 1.0, 1.0], ..SpeedCap::default() })
            }),
            "limits.speed_cap.torque_2_nm = -1 is outside 0 to 50",
        ),
        (
            rejected(|l| l.window = Some(Window { ms: 9, nm: 1.0 })),
            "limits.window.ms = 9 is outside 10 to 5000",
        ),
        (rejected(|l| l.limp_fraction = Some(1.5)), "limits.limp_fraction = 1.5 is outside 0 to 1"),
        (
            rejected(|l| {
                l.max_torque_nm = None;
                l.rider_torque = Some(RiderTorque::default());
            }),
            "limits.max_torque_nm = none, but limits.rider_torque is on and needs it: 0.1 to 50",
        ),
        (
            rejected(|l| l.rider_motion = Some(RiderMotion { fade_ms: 0, ..RiderMotion::default() })),
            "limits.rider_motion.fade_ms = 0 is outside 1 to 5000",
        ),
    ] {
        assert!(message.starts_with(name), "{message}");
    }
}

/// Situation: the table of limits. Must hold: each bit in use has one entry, in the bits' order, with a name of its own.
#[test]
fn every_limit_has_a_name() {
    let bits: Vec<u16> = LIMITS.iter().map(|named| named.limit.0).collect();
    assert_eq!(bits, (0..LIMITS.len()).map(|bit| 1 << bit).collect::<Vec<u16>>());
    let names: std::collections::BTreeSet<&str> = LIMITS.iter().map(|named| named.name).collect();
    assert_eq!(names.len(), LIMITS.len());
    let last = LIMITS[LIMITS.len() - 1].limit;
    assert_eq!(last, ActiveLimits::AUTHORITY);
}
