//! The guard never stops a correct limiter and always stops a faulty one.

use crate::limits::{Reference, at_speed, calls, mirrored, plain, tables};
use control::Cause;
use control::safety::guard::{GuardPlan, GuardState, Violation, check, slack};
use control::safety::limiter::{LimiterPlan, LimiterState, TorqueRequest, step};
use control::safety::limits::*;
use proptest::prelude::*;

/// Faults of a limiter, or between it and the guard.
#[derive(Clone, Copy, Debug)]
enum LimiterFault {
    /// Multiplied by a factor.
    Scaled(f32),
    /// Offset by a constant \[N m\].
    Offset(f32),
    /// Delayed by a number of calls.
    Delayed(usize),
    SignFlipped,
    /// Stuck from this call on.
    Stuck(usize),
    /// Offset in this call \[N m\].
    Glitch(usize, f32),
    /// A limiter whose configuration lacks some limits, or has both rates doubled.
    Table(fn(&mut Limits)),
    /// NaN in this call.
    NotANumber(usize),
}

impl LimiterFault {
    /// The limits that the faulty limiter uses.
    fn table(self, mut table: Limits) -> Limits {
        if let LimiterFault::Table(change) = self {
            change(&mut table);
        }
        table
    }

    /// Torque in call `i` of a faulty limiter, if a correct one's torques so far are `correct`.
    fn torque(self, i: usize, correct: &[f32]) -> f32 {
        let now = correct[i];
        match self {
            LimiterFault::Scaled(factor) => now * factor,
            LimiterFault::Offset(nm) => now + nm,
            LimiterFault::Delayed(calls) => i.checked_sub(calls).map_or(0.0, |j| correct[j]),
            LimiterFault::SignFlipped => -now,
            LimiterFault::Stuck(from) => correct[i.min(from)],
            LimiterFault::Glitch(at, nm) if i == at => now + nm,
            LimiterFault::NotANumber(at) if i == at => f32::NAN,
            LimiterFault::Glitch(..) | LimiterFault::NotANumber(_) | LimiterFault::Table(_) => now,
        }
    }
}

fn any_fault() -> impl Strategy<Value = LimiterFault> {
    let tables: [fn(&mut Limits); 8] = [
        |l| l.window = None,
        |l| l.end_stop = None,
        |l| (l.rider_torque, l.rider_motion) = (None, None),
        |l| (l.rise_nm_s, l.fall_nm_s) = (l.rise_nm_s.map(|r| 2.0 * r), l.fall_nm_s.map(|r| 2.0 * r)),
        |l| l.speed_cap = None,
        |l| l.taper = None,
        |l| l.limp_fraction = None,
        |l| *l = Limits::default(),
    ];
    prop_oneof![
        prop_oneof![Just(1.05_f32), Just(2.0), Just(0.5), 0.0_f32..3.0].prop_map(LimiterFault::Scaled),
        prop_oneof![Just(0.1_f32), -20.0_f32..20.0].prop_map(LimiterFault::Offset),
        (1_usize..50).prop_map(LimiterFault::Delayed),
        Just(LimiterFault::SignFlipped),
        (0_usize..200).prop_map(LimiterFault::Stuck),
        (0_usize..200, -20.0_f32..20.0).prop_map(|(at, nm)| LimiterFault::Glitch(at, nm)),
        proptest::sample::select(tables.to_vec()).prop_map(LimiterFault::Table),
        (0_usize..200).prop_map(LimiterFault::NotANumber),
    ]
}

/// Twice the usual number of cases, because the guard is the last check before the motor.
fn twice() -> ProptestConfig {
    let usual = ProptestConfig::default();
    ProptestConfig { cases: 2 * usual.cases, ..usual }
}

proptest! {
    #![proptest_config(twice())]

    /// Situation: arbitrary limits, call rate and sequence of calls; permission comes and goes, the limiter is cleared
    /// without it.
    /// Action: limit, then check.
    /// Must hold: no violation; every torque passes unchanged to the bit.
    #[test]
    fn a_correct_limiter_is_never_stopped(
        (table, rate_hz) in tables(), sequence in calls(1..100), gaps in any::<u64>(),
    ) {
        let (limiter_plan, guard) = (LimiterPlan::new(&table, rate_hz), GuardPlan::new(&table, rate_hz));
        let (mut limiter, mut guard_state) = (LimiterState::default(), GuardState::default());
        for (i, request) in sequence.iter().enumerate() {
            let permitted = i < 200 || gaps >> (i / 16 % 64) & 1 == 0;
            let mut torque = step(&table, &limiter_plan, &mut limiter, request).0;
            if !permitted {
                (torque, limiter) = (0.0, LimiterState::default());
            }
            let result = check(&table, &guard, &mut guard_state, torque, permitted, request);
            prop_assert_eq!(result.map(f32::to_bits), Ok(torque.to_bits()), "call {} {:?}", i, request);
        }
    }

    /// Situation: arbitrary limits and sequence of calls, a limiter with an arbitrary fault.
    /// Action: check each torque; after each rejection limiter and reference restart.
    /// Must hold: rejected if the torque is outside a limit, by the definitions in f64, by more than rounding (over the
    /// seven eighths of the window that the guard covers for certain); not rejected unless it is outside (over the
    /// whole window).
    #[test]
    fn a_faulty_limiter_is_stopped_outside_the_limits(
        (table, rate_hz) in tables(), sequence in calls(1..100), fault in any_fault(),
    ) {
        let limiter_table = fault.table(table);
        let (limiter_plan, guard) = (LimiterPlan::new(&limiter_table, rate_hz), GuardPlan::new(&table, rate_hz));
        let (mut limiter, mut guard_state) = (LimiterState::default(), GuardState::default());
        let mut reference = Reference::new(&table, rate_hz);
        let mut correct = Vec::new();
        for (i, request) in sequence.iter().enumerate() {
            correct.push(step(&limiter_table, &limiter_plan, &mut limiter, request).0);
            let torque = fault.torque(i, &correct);
            reference.wait(request);
            let (least, rounding) = reference.excess(torque, request, 0.875);
            let (most, _) = reference.excess(torque, request, 1.0);
            let result = check(&table, &guard, &mut guard_state, torque, true, request);
            match result {
                Ok(passed) => {
                    prop_assert_eq!(passed.to_bits(), torque.to_bits());
                    prop_assert!(least <= rounding, "call {i}: {torque} let through, {least} N m outside: {request:?}");
                    reference.output(torque);
                }
                Err(error) => {
                    prop_assert!(
                        most > 0.0 || error == Violation::NotFinite,
                        "call {i}: {torque} stopped for {error:?}: {request:?}"
                    );
                    reference.clear();
                    limiter = LimiterState::default();
                }
            }
        }
    }

    /// Situation: arbitrary limits and calls, and their mirror image.
    /// Action: check both.
    /// Must hold: the same results.
    #[test]
    fn the_guard_is_symmetric(
        (table, rate_hz) in tables(), sequence in calls(1..60), torques in proptest::collection::vec(-20.0_f32..20.0, 60),
    ) {
        let plan = GuardPlan::new(&table, rate_hz);
        let (mut right, mut left) = (GuardState::default(), GuardState::default());
        for (request, torque) in sequence.iter().zip(torques) {
            let a = check(&table, &plan, &mut right, torque, true, request);
            let b = check(&table, &plan, &mut left, -torque, true, &mirrored(request));
            prop_assert_eq!(a, b.map(|t| -t));
        }
    }
}

/// Runs the guard over torques, each with its request; returns the first violation and its call.
fn first_violation(
    table: &Limits,
    torques: impl IntoIterator<Item = (f32, TorqueRequest)>,
) -> Option<(usize, Violation)> {
    let plan = GuardPlan::new(table, 1000.0);
    let mut state = GuardState::default();
    let results =
        torques.into_iter().map(|(torque, request)| check(table, &plan, &mut state, torque, true, &request));
    results.enumerate().find_map(|(i, result)| result.err().map(|error| (i, error)))
}

/// Situation: each limit of the flashed configuration in turn, exceeded alone.
/// Action: check.
/// Must hold: the violation of that limit, in the call in which it occurs; none just inside each limit.
#[test]
fn each_violation_is_named() {
    let off = Limits::default();
    let product = Limits::product();
    let only = |set: fn(&mut Limits, Limits)| {
        let mut table = Limits { max_torque_nm: Some(7.0), ..off };
        set(&mut table, product);
        table
    };
    let at = |request: TorqueRequest, torque: f32| vec![(0.0, plain()), (torque, request)];
    let steered = |steer| TorqueRequest { steer_rad: Some(steer), ..plain() };
    let cap = SpeedCap { speed_m_s: [0.0, 3.0, 6.0, 9.0], torque_nm: [7.0, 7.0, 4.0, 1.0] };
    let ramp = |slope: f32| (0..100).map(|i| (slope * i as f32, plain())).collect::<Vec<_>>();
    let turned = vec![(1.0, TorqueRequest { steer_rate_rad_s: Some(-2.0), ..plain() }); 400];
    let taper = only(|l, p| l.taper = p.taper);
    let stop = only(|l, p| l.end_stop = p.end_stop);
    let rates = Limits { rise_nm_s: Some(100.0), fall_nm_s: Some(200.0), ..off };
    let window = only(|l, _| l.window = Some(Window { ms: 100, nm: 2.0 }));
    let rider_torque = only(|l, _| l.rider_torque = Some(RiderTorque { allowance_nm: 2.0, multiplier: 2.0 }));
    let limp = only(|l, _| l.limp_fraction = Some(0.5));
    let rider_motion = only(|l, p| l.rider_motion = p.rider_motion);
    let override_limit = product.rider_motion.expect("set");
    let after = usize::from(override_limit.after_ms);
    let full = after + usize::from(override_limit.fade_ms);
    for (name, table, torques, at, error) in [
        ("not a number", off, at(plain(), f32::NAN), 1..=1, Violation::NotFinite),
        ("infinite", off, at(plain(), f32::NEG_INFINITY), 1..=1, Violation::NotFinite),
        ("too much", only(|_, _| ()), at(plain(), -7.001), 1..=1, Violation::Magnitude),
        (
            "no authority",
            off,
            at(TorqueRequest { authority: 0.0, ..plain() }, 0.01),
            1..=1,
            Violation::Authority,
        ),
        ("limping", limp, at(TorqueRequest { limp: true, ..plain() }, 3.501), 1..=1, Violation::Limp),
        (
            "too fast",
            Limits { speed_cap: Some(cap), ..off },
            at(at_speed(0.0, 7.5), 2.51),
            1..=1,
            Violation::Speed,
        ),
        ("too slow", taper, at(at_speed(0.0, 1.0), 3.51), 1..=1, Violation::Taper),
        (
            "rider_torque",
            rider_torque,
            at(TorqueRequest { rider_torque_nm: Some(-4.0), ..plain() }, 3.01),
            1..=1,
            Violation::RiderTorque,
        ),
        ("rider_motion", rider_motion, turned, after..=full, Violation::RiderMotion),
        ("stop", stop, at(steered(1.3), 0.01), 1..=1, Violation::EndStop),
        ("stop, left", stop, at(steered(-1.3), -0.01), 1..=1, Violation::EndStop),
        ("rising", rates, ramp(0.101), 1..=1, Violation::Rise),
        (
            "falling",
            rates,
            ramp(0.1).into_iter().chain([(9.69, plain())]).collect(),
            100..=100,
            Violation::Fall,
        ),
        (
            "far across zero",
            Limits { fall_nm_s: Some(1.0), ..off },
            vec![(7.9, plain()), (-4e6, plain())],
            1..=1,
            Violation::Fall,
        ),
        ("window", window, ramp(0.05), 41..=41, Violation::Window),
    ] {
        let violation = first_violation(&table, torques);
        assert!(violation.is_some_and(|(i, w)| at.contains(&i) && w == error), "{name}: {violation:?}");
    }
    // Just inside each limit nothing is rejected.
    for (name, table, torques) in [
        ("largest", only(|_, _| ()), at(plain(), -7.0)),
        ("limping", limp, at(TorqueRequest { limp: true, ..plain() }, 3.5)),
        ("too fast", Limits { speed_cap: Some(cap), ..off }, at(at_speed(0.0, 7.5), 2.5)),
        ("too slow", taper, at(at_speed(0.0, 1.0), 3.5)),
        ("rider_torque", rider_torque, at(TorqueRequest { rider_torque_nm: Some(-4.0), ..plain() }, 3.0)),
        ("back from the stop", stop, at(steered(1.3), -7.0)),
        ("rising", rates, ramp(0.1)),
        ("falling", rates, ramp(0.1).into_iter().chain([(9.7, plain())]).collect()),
        ("window", window, at(plain(), 2.0)),
    ] {
        assert_eq!(first_violation(&table, torques), None, "{name}");
    }
}

/// Situation: 5 N m output when the end-stop, the taper, the authority or the rider's torque no longer allows any.
/// Action: fall at the full rate, at half of it, not at all.
/// Must hold: the first passes down to zero; the others are rejected at once.
#[test]
fn a_torque_outside_must_return_to_zero() {
    let table = Limits::product();
    let fall = table.fall_nm_s.expect("set") / 1000.0;
    for outside in [
        TorqueRequest { steer_rad: Some(1.5), ..plain() },
        at_speed(0.0, 0.2),
        TorqueRequest { authority: 0.0, ..plain() },
        TorqueRequest { rider_torque_nm: Some(-30.0), ..plain() },
    ] {
        for (part, allowed) in [(1.0, true), (0.5, false), (0.0, false)] {
            let up = (0..=50).map(|i| (0.1 * i as f32, plain()));
            let down = (1..=100).map(|i| ((5.0 - part * fall * i as f32).max(0.0), outside));
            let violation = first_violation(&table, up.chain(down));
            assert_eq!(
                violation.map(|(i, _)| i),
                (!allowed).then_some(51),
                "{part} {outside:?} {violation:?}"
            );
        }
    }
}

/// Situation: permission withdrawn and given again.
/// Action: check torques.
/// Must hold: without permission only zero passes; afterwards, and after a violation, the torque must restart from
/// zero.
#[test]
fn without_permission_only_zero() {
    let table = Limits { rise_nm_s: Some(100.0), ..Limits::default() };
    let plan = GuardPlan::new(&table, 1000.0);
    let mut state = GuardState::default();
    let mut result = |torque, permitted| check(&table, &plan, &mut state, torque, permitted, &plain());
    assert_eq!(result(0.1, true), Ok(0.1));
    assert_eq!(result(0.2, true), Ok(0.2));
    assert_eq!(result(0.2, false), Err(Violation::NotPermitted));
    assert_eq!(result(0.2, true), Err(Violation::Rise));
    assert_eq!(result(0.1, true), Ok(0.1));
    assert_eq!(result(0.0, false), Ok(0.0));
    assert_eq!(result(0.11, true), Err(Violation::Rise));
}

/// Situation: limiter and guard as flashed, torque swinging by 20 N m, sensors moving.
/// Action: introduce each fault of the limiter.
/// Must hold: stopped; never stopped without a fault.
#[test]
fn each_fault_of_the_limiter_is_found() {
    let table = Limits { window: Some(Window { ms: 100, nm: 4.0 }), ..Limits::product() };
    let sequence: Vec<TorqueRequest> = (0..4000)
        .map(|i| {
            let t = i as f32 * 1e-3;
            TorqueRequest {
                steer_rad: Some(1.4 * (2.0 * t).sin()),
                steer_rate_rad_s: Some(2.8 * (2.0 * t).cos()),
                rider_torque_nm: Some(20.0 * (3.3 * t).sin()),
                limp: i > 1000,
                ..at_speed(20.0 * (5.0 * t).sin(), 2.0 + 1.5 * t.cos())
            }
        })
        .collect();
    let run = |fault: Option<LimiterFault>| {
        let limiter_table = fault.map_or(table, |b| b.table(table));
        let plan = LimiterPlan::new(&limiter_table, 1000.0);
        let mut limiter = LimiterState::default();
        let mut correct = Vec::new();
        first_violation(
            &table,
            sequence.iter().enumerate().map(|(i, request)| {
                correct.push(step(&limiter_table, &plan, &mut limiter, request).0);
                (fault.map_or(correct[i], |b| b.torque(i, &correct)), *request)
            }),
        )
    };
    assert_eq!(run(None), None);
    for (name, fault) in [
        ("scaled by 1.01", LimiterFault::Scaled(1.01)),
        ("offset by 0.1", LimiterFault::Offset(0.1)),
        ("ten late", LimiterFault::Delayed(10)),
        ("flipped", LimiterFault::SignFlipped),
        ("stuck", LimiterFault::Stuck(300)),
        ("glitch", LimiterFault::Glitch(500, 0.3)),
        ("not a number", LimiterFault::NotANumber(7)),
        ("rates doubled", LimiterFault::Table(|l| (l.rise_nm_s, l.fall_nm_s) = (Some(200.0), Some(400.0)))),
        ("window ignored", LimiterFault::Table(|l| l.window = None)),
        ("end-stop ignored", LimiterFault::Table(|l| l.end_stop = None)),
        ("rider's torque ignored", LimiterFault::Table(|l| l.rider_torque = None)),
        ("rider's motion ignored", LimiterFault::Table(|l| l.rider_motion = None)),
        ("limp ignored", LimiterFault::Table(|l| l.limp_fraction = None)),
        ("taper ignored", LimiterFault::Table(|l| l.taper = None)),
    ] {
        let violation = run(Some(fault));
        assert!(violation.is_some(), "{name}");
        println!("{name}: {violation:?}");
    }
    assert_eq!(run(Some(LimiterFault::Glitch(500, 0.3))).map(|(i, _)| i), Some(500));
}

/// Situation: each limit alone, on both sides.
/// Action: torques float by float about the limit and its slack.
/// Must hold: a torque that less its slack is within the limit passes; the next float is rejected.
#[test]
fn the_limit_and_its_slack_are_allowed() {
    let off = Limits::default();
    let seven = Limits { max_torque_nm: Some(7.0), ..off };
    let cap = SpeedCap { speed_m_s: [1.0, 3.0, 5.0, 6.0], torque_nm: [5.0, 6.0, 4.0, 4.5] };
    let cap = Limits { speed_cap: Some(cap), ..off };
    let rider_torque =
        Limits { rider_torque: Some(RiderTorque { allowance_nm: 1.0, multiplier: 1.0 }), ..seven };
    let window = Limits { window: Some(Window { ms: 100, nm: 4.0 }), ..off };
    let against = |rider: f32| TorqueRequest { rider_torque_nm: Some(rider), ..plain() };
    for (name, table, request, limit, error) in [
        ("largest", seven, plain(), 7.0_f32, Violation::Magnitude),
        ("authority", seven, TorqueRequest { authority: 0.5, ..plain() }, 3.5, Violation::Authority),
        ("cap, slower", cap, at_speed(0.0, 0.5), 5.0, Violation::Speed),
        ("cap, faster", cap, at_speed(0.0, 7.0), 4.5, Violation::Speed),
        ("cap, between", cap, at_speed(0.0, 4.0), 5.0, Violation::Speed),
        ("rider against", rider_torque, against(-4.0), 4.0, Violation::RiderTorque),
        ("rider takes it all", rider_torque, against(-30.0), 0.0, Violation::RiderTorque),
        ("window", window, plain(), 4.0, Violation::Window),
    ] {
        let plan = GuardPlan::new(&table, 1000.0);
        let middle = (limit + slack(limit, 0.0)).to_bits();
        let mut at_the_limit = 0;
        for torque in (middle - 400..middle + 400).map(f32::from_bits) {
            let inside = torque - slack(torque, 0.0);
            at_the_limit += u32::from(inside == limit);
            let expected = if inside <= limit { Ok(torque) } else { Err(error) };
            let checked = |torque: f32, request: &TorqueRequest| {
                check(&table, &plan, &mut GuardState::default(), torque, true, request)
            };
            assert_eq!(checked(torque, &request), expected, "{name}: {torque}");
            assert_eq!(checked(-torque, &mirrored(&request)), expected.map(|t| -t), "{name}: {torque}");
        }
        assert!(at_the_limit > 0, "{name}: no float is just inside");
    }
}

/// Situation: the handlebar turns against the torque at exactly the allowed rate, either way, then faster.
/// Action: hold the torque.
/// Must hold: passes without end at the allowed rate; rejected above it.
#[test]
fn turning_at_the_allowed_rate_is_not_an_override() {
    let rider_motion = RiderMotion { steer_rate_rad_s: 1.0, after_ms: 20, fade_ms: 10 };
    let table = Limits { rider_motion: Some(rider_motion), max_torque_nm: Some(7.0), ..Limits::default() };
    for torque in [5.0_f32, -5.0] {
        let turned = |rate: f32| TorqueRequest { steer_rate_rad_s: Some(rate * torque.signum()), ..plain() };
        assert_eq!(first_violation(&table, vec![(torque, turned(-1.0)); 1000]), None);
        let rejected = first_violation(&table, vec![(torque, turned(-1.001)); 1000]);
        assert!(rejected.is_some_and(|(i, error)| (20..=31).contains(&i) && error == Violation::RiderMotion));
    }
}

/// Situation: limp mode without a largest torque to which the limp fraction would apply.
/// Action: a very large torque.
/// Must hold: passes, as it passes the limiter: a fraction of no limit is no limit.
#[test]
fn a_fraction_of_no_limit_is_no_limit() {
    let table = Limits { limp_fraction: Some(0.5), ..Limits::default() };
    let huge = TorqueRequest { limp: true, wanted_nm: 0.9 * f32::MAX, ..plain() };
    let limited = step(&table, &LimiterPlan::new(&table, 1000.0), &mut LimiterState::default(), &huge).0;
    assert_eq!(limited, huge.wanted_nm);
    assert_eq!(first_violation(&table, [(limited, huge)]), None);
}

/// Situation: every violation.
/// Action: read its cause.
/// Must hold: the cause whose page explains it.
#[test]
fn each_violation_has_its_cause() {
    use Violation::*;
    for (violations, cause) in [
        (&[NotFinite][..], Cause::GuardNotFinite),
        (&[NotPermitted, Authority], Cause::GuardPermission),
        (&[Magnitude, Limp, Speed, Taper], Cause::GuardTorque),
        (&[RiderTorque, RiderMotion], Cause::GuardOverride),
        (&[EndStop], Cause::GuardEndStop),
        (&[Rise, Fall], Cause::GuardRate),
        (&[Window], Cause::GuardWindow),
    ] {
        for violation in violations {
            assert_eq!(violation.cause(), cause, "{violation:?}");
        }
    }
}

/// Situation: the slack at product torques and at zero.
/// Action: compute it.
/// Must hold: as documented, and at most 0.1 mN m.
#[test]
fn the_slack_is_small() {
    assert!((slack(7.0, 7.0) - 7.8e-5).abs() < 1e-9 && slack(7.0, 7.0) < 1e-4);
    assert!((slack(0.0, 0.0) - 5e-5).abs() < 1e-9);
}
