//! Flight cards: the guard never stops a sound shaper, always stops a broken one.

use crate::limits::{Truth, at_speed, calls, mirrored, plain, tables};
use control::Cause;
use control::safety::guard::{GuardPlan, GuardState, Violation, check, slack};
use control::safety::limiter::{LimiterPlan, LimiterState, TorqueRequest, step};
use control::safety::limits::*;
use proptest::prelude::*;

/// What can be wrong with a shaper, or between it and the guard.
#[derive(Clone, Copy, Debug)]
enum Broken {
    /// By a factor.
    Scaled(f32),
    /// By a constant \[N m\].
    Offset(f32),
    /// By so many calls.
    Delayed(usize),
    SignFlipped,
    /// From this call on.
    Stuck(usize),
    /// In this call, by so much \[N m\].
    Glitch(usize, f32),
    /// It works by a table without some limits, or with both rates doubled.
    Table(fn(&mut Limits)),
    /// A not-a-number in this call.
    NotANumber(usize),
}

impl Broken {
    /// The table that the shaper works by.
    fn table(self, mut table: Limits) -> Limits {
        if let Broken::Table(change) = self {
            change(&mut table);
        }
        table
    }

    /// What comes out in call `i` of a shaper whose torques so far are `sound`.
    fn torque(self, i: usize, sound: &[f32]) -> f32 {
        let now = sound[i];
        match self {
            Broken::Scaled(factor) => now * factor,
            Broken::Offset(nm) => now + nm,
            Broken::Delayed(calls) => i.checked_sub(calls).map_or(0.0, |j| sound[j]),
            Broken::SignFlipped => -now,
            Broken::Stuck(from) => sound[i.min(from)],
            Broken::Glitch(at, nm) if i == at => now + nm,
            Broken::NotANumber(at) if i == at => f32::NAN,
            Broken::Glitch(..) | Broken::NotANumber(_) | Broken::Table(_) => now,
        }
    }
}

fn any_break() -> impl Strategy<Value = Broken> {
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
        prop_oneof![Just(1.05_f32), Just(2.0), Just(0.5), 0.0_f32..3.0].prop_map(Broken::Scaled),
        prop_oneof![Just(0.1_f32), -20.0_f32..20.0].prop_map(Broken::Offset),
        (1_usize..50).prop_map(Broken::Delayed),
        Just(Broken::SignFlipped),
        (0_usize..200).prop_map(Broken::Stuck),
        (0_usize..200, -20.0_f32..20.0).prop_map(|(at, nm)| Broken::Glitch(at, nm)),
        proptest::sample::select(tables.to_vec()).prop_map(Broken::Table),
        (0_usize..200).prop_map(Broken::NotANumber),
    ]
}

/// Twice the usual cases, for nothing stands between the guard and the motor.
fn twice() -> ProptestConfig {
    let usual = ProptestConfig::default();
    ProptestConfig { cases: 2 * usual.cases, ..usual }
}

proptest! {
    #![proptest_config(twice())]

    /// Situation: any table, rate of calls and sequence of calls; permission comes and goes, the shaper cleared
    /// without it. Action: shape, judge.
    /// Must hold: never a violation, every torque let through in every bit.
    #[test]
    fn a_sound_shaper_is_never_stopped(
        (table, rate_hz) in tables(), sequence in calls(1..100), gaps in any::<u64>(),
    ) {
        let (shape, guard) = (LimiterPlan::new(&table, rate_hz), GuardPlan::new(&table, rate_hz));
        let (mut shaper, mut guarding) = (LimiterState::default(), GuardState::default());
        for (i, request) in sequence.iter().enumerate() {
            let permitted = i < 200 || gaps >> (i / 16 % 64) & 1 == 0;
            let mut torque = step(&table, &shape, &mut shaper, request).0;
            if !permitted {
                (torque, shaper) = (0.0, LimiterState::default());
            }
            let verdict = check(&table, &guard, &mut guarding, torque, permitted, request);
            prop_assert_eq!(verdict.map(f32::to_bits), Ok(torque.to_bits()), "call {} {:?}", i, request);
        }
    }

    /// Situation: any table and sequence, a shaper broken in any way.
    /// Action: judge each torque; whenever it is refused all begin anew.
    /// Must hold: refused whenever it is outside a limit, by the definitions in f64, by more than
    /// rounding; and only then (over the seven eighths of the window that the guard is sure of, and over the whole).
    #[test]
    fn a_broken_shaper_is_stopped_whenever_it_matters(
        (table, rate_hz) in tables(), sequence in calls(1..100), broken in any_break(),
    ) {
        let known = broken.table(table);
        let (shape, guard) = (LimiterPlan::new(&known, rate_hz), GuardPlan::new(&table, rate_hz));
        let (mut shaper, mut guarding) = (LimiterState::default(), GuardState::default());
        let mut truth = Truth::new(&table, rate_hz);
        let mut sound = Vec::new();
        for (i, request) in sequence.iter().enumerate() {
            sound.push(step(&known, &shape, &mut shaper, request).0);
            let torque = broken.torque(i, &sound);
            truth.wait(request);
            let (least, rounding) = truth.excess(torque, request, 0.875);
            let (most, _) = truth.excess(torque, request, 1.0);
            let verdict = check(&table, &guard, &mut guarding, torque, true, request);
            match verdict {
                Ok(passed) => {
                    prop_assert_eq!(passed.to_bits(), torque.to_bits());
                    prop_assert!(least <= rounding, "call {i}: {torque} let through, {least} N m outside: {request:?}");
                    truth.output(torque);
                }
                Err(why) => {
                    prop_assert!(
                        most > 0.0 || why == Violation::NotFinite,
                        "call {i}: {torque} stopped for {why:?}: {request:?}"
                    );
                    truth.clear();
                    shaper = LimiterState::default();
                }
            }
        }
    }

    /// Situation: as above, and its mirror image. Action: judge both. Must hold: the same verdicts.
    #[test]
    fn the_guard_has_no_favourite_side(
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

/// Runs a table's guard over torques, each with its situation; the first refusal and its call.
fn first_refusal(
    table: &Limits,
    torques: impl IntoIterator<Item = (f32, TorqueRequest)>,
) -> Option<(usize, Violation)> {
    let plan = GuardPlan::new(table, 1000.0);
    let mut state = GuardState::default();
    let verdicts =
        torques.into_iter().map(|(torque, request)| check(table, &plan, &mut state, torque, true, &request));
    verdicts.enumerate().find_map(|(i, verdict)| verdict.err().map(|why| (i, why)))
}

/// Situation: each limit of the product in turn, exceeded alone. Action: judge.
/// Must hold: the refusal that names it, in the call in which it happens.
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
    let felt = only(|l, _| l.rider_torque = Some(RiderTorque { allowance_nm: 2.0, multiplier: 2.0 }));
    let limp = only(|l, _| l.limp_fraction = Some(0.5));
    let seen = only(|l, p| l.rider_motion = p.rider_motion);
    let gives_way = product.rider_motion.expect("set");
    let after = usize::from(gives_way.after_ms);
    let full = after + usize::from(gives_way.fade_ms);
    for (name, table, torques, at, why) in [
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
            "felt",
            felt,
            at(TorqueRequest { rider_torque_nm: Some(-4.0), ..plain() }, 3.01),
            1..=1,
            Violation::RiderTorque,
        ),
        ("seen", seen, turned, after..=full, Violation::RiderMotion),
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
        let refusal = first_refusal(&table, torques);
        assert!(refusal.is_some_and(|(i, w)| at.contains(&i) && w == why), "{name}: {refusal:?}");
    }
    // Just inside each of them nothing is refused.
    for (name, table, torques) in [
        ("largest", only(|_, _| ()), at(plain(), -7.0)),
        ("limping", limp, at(TorqueRequest { limp: true, ..plain() }, 3.5)),
        ("too fast", Limits { speed_cap: Some(cap), ..off }, at(at_speed(0.0, 7.5), 2.5)),
        ("too slow", taper, at(at_speed(0.0, 1.0), 3.5)),
        ("felt", felt, at(TorqueRequest { rider_torque_nm: Some(-4.0), ..plain() }, 3.0)),
        ("back from the stop", stop, at(steered(1.3), -7.0)),
        ("rising", rates, ramp(0.1)),
        ("falling", rates, ramp(0.1).into_iter().chain([(9.7, plain())]).collect()),
        ("window", window, at(plain(), 2.0)),
    ] {
        assert_eq!(first_refusal(&table, torques), None, "{name}");
    }
}

/// Situation: 5 N m in force when the end-stop, the taper or the authority leaves none.
/// Action: fall as fast as the rate lets it, half as fast, stay.
/// Must hold: the first passes down to zero, the others are refused at once.
#[test]
fn what_is_outside_must_come_back() {
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
            let refusal = first_refusal(&table, up.chain(down));
            assert_eq!(refusal.map(|(i, _)| i), (!allowed).then_some(51), "{part} {outside:?} {refusal:?}");
        }
    }
}

/// Situation: no permission, then permission again. Action: judge. Must hold: only zero without, from zero on with,
/// and after a refusal too.
#[test]
fn without_permission_only_zero() {
    let table = Limits { rise_nm_s: Some(100.0), ..Limits::default() };
    let plan = GuardPlan::new(&table, 1000.0);
    let mut state = GuardState::default();
    let mut verdict = |torque, permitted| check(&table, &plan, &mut state, torque, permitted, &plain());
    assert_eq!(verdict(0.1, true), Ok(0.1));
    assert_eq!(verdict(0.2, true), Ok(0.2));
    assert_eq!(verdict(0.2, false), Err(Violation::NotPermitted));
    assert_eq!(verdict(0.2, true), Err(Violation::Rise));
    assert_eq!(verdict(0.1, true), Ok(0.1));
    assert_eq!(verdict(0.0, false), Ok(0.0));
    assert_eq!(verdict(0.11, true), Err(Violation::Rise));
}

/// Situation: the product's shaper and guard, torque swinging by 20 N m, sensors moving. Action: break the shaper
/// in each way. Must hold: stopped, and not before it breaks.
#[test]
fn each_fault_of_the_shaper_is_found() {
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
    let run = |broken: Option<Broken>| {
        let known = broken.map_or(table, |b| b.table(table));
        let plan = LimiterPlan::new(&known, 1000.0);
        let mut shaper = LimiterState::default();
        let mut sound = Vec::new();
        first_refusal(
            &table,
            sequence.iter().enumerate().map(|(i, request)| {
                sound.push(step(&known, &plan, &mut shaper, request).0);
                (broken.map_or(sound[i], |b| b.torque(i, &sound)), *request)
            }),
        )
    };
    assert_eq!(run(None), None);
    for (name, broken) in [
        ("scaled by 1.01", Broken::Scaled(1.01)),
        ("offset by 0.1", Broken::Offset(0.1)),
        ("ten late", Broken::Delayed(10)),
        ("flipped", Broken::SignFlipped),
        ("stuck", Broken::Stuck(300)),
        ("glitch", Broken::Glitch(500, 0.3)),
        ("not a number", Broken::NotANumber(7)),
        ("rates doubled", Broken::Table(|l| (l.rise_nm_s, l.fall_nm_s) = (Some(200.0), Some(400.0)))),
        ("window ignored", Broken::Table(|l| l.window = None)),
        ("end-stop ignored", Broken::Table(|l| l.end_stop = None)),
        ("rider's torque ignored", Broken::Table(|l| l.rider_torque = None)),
        ("rider's motion ignored", Broken::Table(|l| l.rider_motion = None)),
        ("limp ignored", Broken::Table(|l| l.limp_fraction = None)),
        ("taper ignored", Broken::Table(|l| l.taper = None)),
    ] {
        let refusal = run(Some(broken));
        assert!(refusal.is_some(), "{name}");
        println!("{name}: {refusal:?}");
    }
    assert_eq!(run(Some(Broken::Glitch(500, 0.3))).map(|(i, _)| i), Some(500));
}

/// Situation: each limit alone, on both sides. Action: torques float by float about the limit and its slack.
/// Must hold: what the slack takes back to the limit itself is let through, the next float refused.
#[test]
fn the_limit_and_its_slack_are_allowed() {
    let off = Limits::default();
    let seven = Limits { max_torque_nm: Some(7.0), ..off };
    let cap = SpeedCap { speed_m_s: [1.0, 3.0, 5.0, 6.0], torque_nm: [5.0, 6.0, 4.0, 4.5] };
    let cap = Limits { speed_cap: Some(cap), ..off };
    let felt = Limits { rider_torque: Some(RiderTorque { allowance_nm: 1.0, multiplier: 1.0 }), ..seven };
    let window = Limits { window: Some(Window { ms: 100, nm: 4.0 }), ..off };
    let against = |rider: f32| TorqueRequest { rider_torque_nm: Some(rider), ..plain() };
    for (name, table, request, limit, why) in [
        ("largest", seven, plain(), 7.0_f32, Violation::Magnitude),
        ("authority", seven, TorqueRequest { authority: 0.5, ..plain() }, 3.5, Violation::Authority),
        ("cap, slower", cap, at_speed(0.0, 0.5), 5.0, Violation::Speed),
        ("cap, faster", cap, at_speed(0.0, 7.0), 4.5, Violation::Speed),
        ("cap, between", cap, at_speed(0.0, 4.0), 5.0, Violation::Speed),
        ("rider against", felt, against(-4.0), 4.0, Violation::RiderTorque),
        ("rider takes it all", felt, against(-30.0), 0.0, Violation::RiderTorque),
        ("window", window, plain(), 4.0, Violation::Window),
    ] {
        let plan = GuardPlan::new(&table, 1000.0);
        let middle = (limit + slack(limit, 0.0)).to_bits();
        let mut at_the_limit = 0;
        for torque in (middle - 400..middle + 400).map(f32::from_bits) {
            let inside = torque - slack(torque, 0.0);
            at_the_limit += u32::from(inside == limit);
            let expected = if inside <= limit { Ok(torque) } else { Err(why) };
            let checked = |torque: f32, request: &TorqueRequest| {
                check(&table, &plan, &mut GuardState::default(), torque, true, request)
            };
            assert_eq!(checked(torque, &request), expected, "{name}: {torque}");
            assert_eq!(checked(-torque, &mirrored(&request)), expected.map(|t| -t), "{name}: {torque}");
        }
        assert!(at_the_limit > 0, "{name}: no float is just inside");
    }
}

/// Situation: the handlebar turns against the torque exactly as fast as is allowed, either way, then faster. Action: hold the torque.
/// Must hold: let through for ever, then refused.
#[test]
fn turning_as_fast_as_allowed_is_no_override() {
    let gives_way = RiderMotion { steer_rate_rad_s: 1.0, after_ms: 20, fade_ms: 10 };
    let table = Limits { rider_motion: Some(gives_way), max_torque_nm: Some(7.0), ..Limits::default() };
    for torque in [5.0_f32, -5.0] {
        let turned = |rate: f32| TorqueRequest { steer_rate_rad_s: Some(rate * torque.signum()), ..plain() };
        assert_eq!(first_refusal(&table, vec![(torque, turned(-1.0)); 1000]), None);
        let refused = first_refusal(&table, vec![(torque, turned(-1.001)); 1000]);
        assert!(refused.is_some_and(|(i, why)| (20..=31).contains(&i) && why == Violation::RiderMotion));
    }
}

/// Situation: limping by a table without a largest torque, of which the limp fraction would be a part. Action: a huge torque.
/// Must hold: let through, as the shaper does; a part of no limit is none.
#[test]
fn a_part_of_no_limit_is_none() {
    let table = Limits { limp_fraction: Some(0.5), ..Limits::default() };
    let huge = TorqueRequest { limp: true, wanted_nm: 0.9 * f32::MAX, ..plain() };
    let shaped = step(&table, &LimiterPlan::new(&table, 1000.0), &mut LimiterState::default(), &huge).0;
    assert_eq!(shaped, huge.wanted_nm);
    assert_eq!(first_refusal(&table, [(shaped, huge)]), None);
}

/// Situation: every violation. Action: ask for its cause. Must hold: the code whose page explains it.
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

/// Situation: the tolerance. Must hold: it is what the documentation says, and no more than 0.1 mN m at product torques.
#[test]
fn the_slack_is_small() {
    assert!((slack(7.0, 7.0) - 7.8e-5).abs() < 1e-9 && slack(7.0, 7.0) < 1e-4);
    assert!((slack(0.0, 0.0) - 5e-5).abs() < 1e-9);
}
