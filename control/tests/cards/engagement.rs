//! Engagement: when torque is permitted, and what withdraws the permission.

use control::estimate::RollError;
use control::safety::engagement::{
    EngagementInput, EngagementOutput, EngagementPlan, EngagementState, Reactions, step,
};
use control::safety::press::PressConfig;
use control::{Cause, Causes, Config, EngagementConfig, Mode};

const CONFIG: EngagementConfig = EngagementConfig {
    self_test_ticks: 10,
    ramp_in_ticks: 20,
    ramp_out_ticks: 5,
    press: PressConfig { release_ticks: 0, press_ticks: 0 },
    need_polarity: true,
    fallen_rad: Some(1.0),
    roll_unknown_rad: Some(0.5),
    crash_m_s2: Some(60.0),
    parked_m_s: Some(0.3),
    backwards_m_s: Some(0.3),
    lifted_m_s2: Some(3.0),
    persist_ticks: 3,
};

/// An exact roll angle.
const EXACT: RollError = RollError { square_rad2: 0.0, systematic_rad: 0.0 };

/// Riding upright at 4 m/s, no causes, the switch off.
const NORMAL: EngagementInput = EngagementInput {
    causes: Causes::NONE,
    engage: false,
    polarity_checked: true,
    roll_rad: Some((0.1, EXACT)),
    rates_rad_s: [0.0; 2],
    speed_m_s: Some(4.0),
    force_m_s2: Some(9.8),
};

const PRESSED: EngagementInput = EngagementInput { engage: true, ..NORMAL };

struct Bench {
    config: EngagementConfig,
    reactions: Reactions,
    state: EngagementState,
}

impl Bench {
    fn new() -> Self {
        let reactions = Reactions::new(&Config::product().input);
        Self { config: CONFIG, reactions, state: EngagementState::default() }
    }

    fn step(&mut self, input: &EngagementInput) -> EngagementOutput {
        step(
            &self.config,
            &EngagementPlan::new(&self.config, 1000.0),
            &self.reactions,
            &mut self.state,
            input,
        )
    }

    /// The output after `ticks` periods of the same input.
    fn hold(&mut self, input: &EngagementInput, ticks: usize) -> EngagementOutput {
        (0..ticks).map(|_| self.step(input)).last().expect("at least one")
    }

    /// Engaged with full authority.
    fn engaged() -> Self {
        let mut bench = Self::new();
        assert_eq!(bench.hold(&NORMAL, 20).mode, Mode::Standby);
        let whole = bench.hold(&PRESSED, 25);
        assert_eq!((whole.mode, whole.authority), (Mode::Engaged, 1.0));
        assert!(whole.causes.is_empty());
        bench
    }
}

/// Situation: power-up with the switch released.
/// Action: wait, press, wait, release.
/// Must hold: off, initialise, self-test for its time, standby; authority only after the press, in twenty equal steps,
/// and down in five.
#[test]
fn from_boot_to_torque_and_back() {
    let mut bench = Bench::new();
    let mut modes = Vec::new();
    for _ in 0..20 {
        let p = bench.step(&NORMAL);
        assert_eq!(p.authority, 0.0);
        assert_eq!(p.causes.has(Cause::SelfTest), modes.len() < 13, "{}", modes.len());
        assert!(p.causes.has(Cause::SwitchOff));
        modes.push(p.mode);
    }
    assert_eq!(modes[..2], [Mode::Initialise, Mode::SelfTest]);
    assert!(
        modes[1..12].iter().all(|m| *m == Mode::SelfTest) && modes[12..].iter().all(|m| *m == Mode::Standby)
    );
    for k in 1..=20 {
        let p = bench.step(&PRESSED);
        assert_eq!(p.mode, Mode::Engaged);
        assert!((p.authority - k as f32 / 20.0).abs() < 1e-6, "{k}: {}", p.authority);
    }
    assert_eq!(bench.step(&PRESSED).authority, 1.0, "to the bit");
    for k in 1..=5 {
        let p = bench.step(&NORMAL);
        assert_eq!(p.mode, Mode::Standby);
        assert!((p.authority - (1.0 - k as f32 / 5.0)).abs() < 1e-6);
    }
    assert_eq!(bench.step(&NORMAL).authority, 0.0);
}

/// Situation: the switch is stuck on at boot.
/// Action: wait long, then release and press.
/// Must hold: never engaged while held, and the causes report a held switch; after release and press it engages.
#[test]
fn a_switch_held_at_boot_does_not_engage() {
    let mut bench = Bench::new();
    let p = bench.hold(&PRESSED, 1000);
    assert_eq!((p.mode, p.authority), (Mode::Standby, 0.0));
    assert!(p.causes.has(Cause::SwitchHeld) && !p.causes.has(Cause::SwitchOff));
    bench.step(&NORMAL);
    assert_eq!(bench.step(&PRESSED).mode, Mode::Engaged);
}

/// Situation: a cause rejects the press in standby, or the self-test is not complete.
/// Action: press and hold; then the cause disappears.
/// Must hold: the press is consumed and reported as a held switch, however long it is held; after release and press it
/// engages.
#[test]
fn a_rejected_press_is_consumed() {
    let rejections = [
        (EngagementInput { polarity_checked: false, ..NORMAL }, Cause::PolarityUnchecked),
        (EngagementInput { causes: Causes::of(Cause::PolarityWrong), ..NORMAL }, Cause::PolarityWrong),
        (EngagementInput { roll_rad: Some((1.2, EXACT)), ..NORMAL }, Cause::Fallen),
        (EngagementInput { force_m_s2: Some(1.0), ..NORMAL }, Cause::Lifted),
        (EngagementInput { speed_m_s: Some(0.1), ..NORMAL }, Cause::Parked),
        (EngagementInput { speed_m_s: Some(-1.0), ..NORMAL }, Cause::Backwards),
        (NORMAL, Cause::SelfTest),
    ];
    for (input, cause) in rejections {
        let mut bench = Bench::new();
        bench.hold(&input, if cause == Cause::SelfTest { 5 } else { 30 });
        let p = bench.step(&EngagementInput { engage: true, ..input });
        assert!(!p.mode.drives() && p.causes.has(cause), "{cause:?}: {p:?}");
        for _ in 0..200 {
            let p = bench.step(&PRESSED);
            assert!(
                !p.mode.drives() && p.authority == 0.0 && p.causes.has(Cause::SwitchHeld),
                "{cause:?}: {p:?}"
            );
        }
        assert_eq!(
            bench.step(&PRESSED).causes,
            Causes::of(Cause::SwitchHeld),
            "{cause:?}: nothing else is left"
        );
        assert_eq!(bench.step(&NORMAL).mode, Mode::Standby, "{cause:?}");
        assert_eq!(bench.step(&PRESSED).mode, Mode::Engaged, "{cause:?}");
    }
}

/// Situation: several causes are present at once.
/// Action: press.
/// Must hold: rejected, and all causes are reported at once.
#[test]
fn every_rejection_is_listed() {
    let mut bench = Bench::new();
    let input = EngagementInput {
        polarity_checked: false,
        roll_rad: Some((-1.2, EXACT)),
        speed_m_s: Some(-0.4),
        force_m_s2: Some(1.0),
        causes: Causes::of(Cause::WheelsDisagree),
        ..NORMAL
    };
    bench.hold(&input, 30);
    let p = bench.step(&EngagementInput { engage: true, ..input });
    assert_eq!(p.mode, Mode::Standby);
    let reported: Vec<Cause> = p.causes.iter().collect();
    let expected =
        [Cause::WheelsDisagree, Cause::PolarityUnchecked, Cause::Fallen, Cause::Lifted, Cause::Backwards];
    assert_eq!(reported, expected);
}

/// Situation: engaged.
/// Action: fall to either side, lift off, lose the polarity check; each for the allowed time and one period longer.
/// Must hold: still engaged for the allowed time, then standby; a held switch does not engage again.
#[test]
fn fallen_or_lifted_needs_a_new_press() {
    let inputs = [
        (EngagementInput { roll_rad: Some((1.01, EXACT)), ..PRESSED }, Cause::Fallen, 3),
        (EngagementInput { roll_rad: Some((-1.01, EXACT)), ..PRESSED }, Cause::Fallen, 3),
        (EngagementInput { force_m_s2: Some(2.9), ..PRESSED }, Cause::Lifted, 3),
        (EngagementInput { polarity_checked: false, ..PRESSED }, Cause::PolarityUnchecked, 0),
    ];
    for (input, cause, allowed_ticks) in inputs {
        let mut bench = Bench::engaged();
        for _ in 0..allowed_ticks {
            assert_eq!(bench.step(&input).mode, Mode::Engaged, "{cause:?}");
        }
        let p = bench.step(&input);
        assert!(p.mode == Mode::Standby && p.causes.has(cause), "{cause:?}: {p:?}");
        let p = bench.hold(&PRESSED, 100);
        assert_eq!((p.mode, p.authority), (Mode::Standby, 0.0), "{cause:?}: the switch was held");
        bench.step(&NORMAL);
        assert_eq!(bench.step(&PRESSED).mode, Mode::Engaged, "{cause:?}");
    }
    // Just inside the limits nothing happens.
    let mut bench = Bench::engaged();
    let inside = EngagementInput {
        roll_rad: Some((0.99, EXACT)),
        force_m_s2: Some(3.01),
        speed_m_s: Some(0.31),
        ..PRESSED
    };
    assert_eq!(bench.hold(&inside, 100).authority, 1.0);
}

/// Situation: engaged, with an estimated roll angle of 1.3 rad to either side.
/// Action: error bounds from 0 to pi.
/// Must hold: fallen only if even the nearest angle within the bound is beyond 1 rad; a bound beyond 0.5 rad is
/// reported by its own cause, which does not affect the torque.
#[test]
fn an_uncertain_angle_is_not_a_fall() {
    for (bound, falls, unknown) in [
        (0.0, true, false),
        (0.29, true, false),
        (0.31, false, false),
        (0.5, false, false),
        (0.51, false, true),
        (3.1, false, true),
    ] {
        for roll in [1.3, -1.3] {
            let mut bench = Bench::engaged();
            let p = bench.hold(
                &EngagementInput {
                    roll_rad: Some((roll, RollError { square_rad2: 0.0, systematic_rad: bound })),
                    ..PRESSED
                },
                50,
            );
            assert_eq!(p.causes.has(Cause::Fallen), falls, "{bound}");
            assert_eq!(p.causes.has(Cause::RollUnknown), unknown, "{bound}");
            assert_eq!(p.mode, if falls { Mode::Standby } else { Mode::Engaged }, "{bound}");
            assert_eq!(p.authority, if falls { 0.0 } else { 1.0 }, "{bound}");
        }
    }
}

/// Situation: engaged.
/// Action: a crash force for one period; a fast roll or steer rate with it, up to 0.1 s and more than 0.1 s after it;
/// force and rates each alone and for long.
/// Must hold: a fault in the period in which the rate occurs, up to 0.1 s after the force; no fault by force or rates
/// alone, which occur in hard riding.
#[test]
fn a_crash_needs_force_and_rate() {
    let force = EngagementInput { force_m_s2: Some(61.0), ..PRESSED };
    let calm = EngagementInput { force_m_s2: Some(59.0), rates_rad_s: [1.9, -7.9], ..PRESSED };
    for rates_rad_s in [[-2.1, 0.0], [0.0, 8.1]] {
        let rates = EngagementInput { rates_rad_s, ..PRESSED };
        let both = Bench::engaged().step(&EngagementInput { force_m_s2: Some(61.0), ..rates });
        assert!(both.mode == Mode::Fault && both.causes.has(Cause::Crash), "{both:?}");
        for (apart, crashes) in [(0, true), (98, true), (99, false), (300, false)] {
            let mut bench = Bench::engaged();
            assert_eq!(bench.step(&force).mode, Mode::Engaged);
            assert_eq!((0..apart).map(|_| bench.step(&calm).mode).find(|m| *m != Mode::Engaged), None);
            let p = bench.step(&rates);
            assert_eq!(p.causes.has(Cause::Crash), crashes, "{apart} periods apart");
            assert_eq!(p.mode == Mode::Fault && p.authority == 0.0, crashes, "{apart} periods apart");
        }
        assert_eq!(Bench::engaged().hold(&rates, 1000).mode, Mode::Engaged);
    }
    assert_eq!(Bench::engaged().hold(&force, 1000).mode, Mode::Engaged);
    assert_eq!(Bench::engaged().hold(&calm, 1000).mode, Mode::Engaged);
}

/// Situation: engaged; the bicycle stops, or rolls back.
/// Action: wait, ride on.
/// Must hold: torque ramps out while engaged, and ramps in again without a press.
#[test]
fn standing_still_pauses() {
    for (speed, cause) in [(0.2, Cause::Parked), (-0.5, Cause::Backwards)] {
        let mut bench = Bench::engaged();
        let p = bench.hold(&EngagementInput { speed_m_s: Some(speed), ..PRESSED }, 30);
        assert_eq!((p.mode, p.authority), (Mode::Engaged, 0.0));
        assert!(p.causes.has(cause));
        let p = bench.hold(&PRESSED, 30);
        assert_eq!((p.mode, p.authority), (Mode::Engaged, 1.0));
    }
}

/// Situation: engaged.
/// Action: every fault cause, for one period each.
/// Must hold: no authority in that period; the cause stays reported; only valid sensors, a released switch, the
/// self-test and a new press engage again.
#[test]
fn a_fault_needs_a_restart() {
    let reactions = Reactions::new(&Config::product().input);
    let faults: Vec<Cause> = reactions.fault.iter().collect();
    assert!(faults.contains(&Cause::GyroLost) && faults.contains(&Cause::GuardRate) && faults.len() > 12);
    for cause in faults {
        let mut bench = Bench::engaged();
        let p = bench.step(&EngagementInput { causes: Causes::of(cause), ..PRESSED });
        assert_eq!((p.mode, p.authority), (Mode::Fault, 0.0), "{cause:?}");
        let p = bench.hold(&PRESSED, 200);
        assert!(p.mode == Mode::Fault && p.causes.has(cause), "{cause:?}: {p:?}");
        let p = bench.hold(&NORMAL, 1);
        assert_eq!(p.mode, Mode::Initialise, "{cause:?}");
        assert_eq!(bench.hold(&NORMAL, 20).mode, Mode::Standby, "{cause:?}");
        assert_eq!(bench.step(&PRESSED).mode, Mode::Engaged, "{cause:?}");
    }
}

/// Situation: engaged.
/// Action: every limp cause appears and disappears.
/// Must hold: limp mode with full authority while the cause is present, then engaged again; disagreements between
/// sensors stay set and reported until the rider engages again.
#[test]
fn limp_causes_reduce_torque_while_present() {
    let reactions = Reactions::new(&Config::product().input);
    let limps: Vec<Cause> = reactions.limp.iter().collect();
    assert!(limps.contains(&Cause::WheelsDisagree) && limps.contains(&Cause::SteerStuck) && limps.len() > 15);
    for cause in limps {
        let mut bench = Bench::engaged();
        let p = bench.hold(&EngagementInput { causes: Causes::of(cause), ..PRESSED }, 50);
        assert_eq!((p.mode, p.authority), (Mode::Limp, 1.0), "{cause:?}");
        let p = bench.hold(&PRESSED, 1000);
        if reactions.until_reengaged.has(cause) {
            assert!(p.mode == Mode::Limp && p.causes.has(cause), "{cause:?}");
            bench.hold(&NORMAL, 2);
        }
        assert_eq!(bench.step(&PRESSED).mode, Mode::Engaged, "{cause:?}");
    }
}

/// Situation: engaged.
/// Action: exactly the limits of roll angle, specific force, speed and backward speed.
/// Must hold: no cause: the limits themselves are allowed.
#[test]
fn the_limits_themselves_are_allowed() {
    let mut bench = Bench::engaged();
    for (roll, speed) in [(1.0, 0.3), (-1.0, -0.3)] {
        let at = EngagementInput {
            roll_rad: Some((roll, EXACT)),
            speed_m_s: Some(speed),
            force_m_s2: Some(3.0),
            ..PRESSED
        };
        let p = bench.hold(&at, 100);
        assert_eq!((p.mode, p.authority, p.causes), (Mode::Engaged, 1.0, Causes::NONE), "{roll} {speed}");
    }
}

/// Situation: engaged; the bicycle stands, then rides on, each for less and for more than the persistence time.
/// Action: step.
/// Must hold: a pause begins, and ends, only after its condition has lasted one period longer than the persistence time
/// without interruption.
#[test]
fn a_pause_is_debounced() {
    let mut bench = Bench::engaged();
    let standing = EngagementInput { speed_m_s: Some(0.0), ..PRESSED };
    let mut parked = |input: &EngagementInput, ticks| bench.hold(input, ticks).causes.has(Cause::Parked);
    assert!(!parked(&standing, 3) && !parked(&PRESSED, 1) && !parked(&standing, 3));
    assert!(parked(&standing, 1) && parked(&standing, 50));
    assert!(parked(&PRESSED, 3) && parked(&standing, 1) && parked(&PRESSED, 3));
    assert!(!parked(&PRESSED, 1) && !parked(&PRESSED, 50));
}

/// Situation: a fault, further fault causes while it lasts, and another fault after a restart.
/// Action: step.
/// Must hold: every cause since the present fault began is reported, none of the previous fault.
#[test]
fn a_fault_lists_its_causes_since_it_began() {
    let mut bench = Bench::engaged();
    let one = |cause| EngagementInput { causes: Causes::of(cause), ..PRESSED };
    for cause in [Cause::GyroLost, Cause::MotorLost] {
        bench.step(&one(cause));
    }
    let both = Causes::all(&[Cause::GyroLost, Cause::MotorLost]);
    assert_eq!(bench.step(&PRESSED).causes.and(both), both);
    assert_eq!(bench.hold(&NORMAL, 30).mode, Mode::Standby);
    bench.hold(&PRESSED, 30);
    let p = bench.step(&one(Cause::GuardRate));
    assert_eq!(
        (p.mode, p.causes.and(both), p.causes.has(Cause::GuardRate)),
        (Mode::Fault, Causes::NONE, true)
    );
}

/// Situation: ramps of many lengths, including zero.
/// Action: press, hold, release.
/// Must hold: equal steps; exactly 1 and 0 after the declared number of periods; for the longest, where rounding adds
/// up, within 1 %.
#[test]
fn ramps_take_the_declared_time() {
    for ticks in [0, 1, 2, 3, 5, 7, 10, 30, 100, 200, 500, 1000, 20_000_u16] {
        let mut bench = Bench::new();
        (bench.config.ramp_in_ticks, bench.config.ramp_out_ticks) = (ticks, ticks);
        bench.hold(&NORMAL, 20);
        for (input, start) in [(PRESSED, 0.0_f32), (NORMAL, 1.0)] {
            let most = 2 * usize::from(ticks) + 2;
            let ramp: Vec<f32> = (0..most).map(|_| (bench.step(&input).authority - start).abs()).collect();
            let step = 1.0 / f32::from(ticks.max(1));
            let taken = 1 + ramp.iter().position(|part| *part == 1.0).expect("arrives");
            let declared = usize::from(ticks.max(1));
            let late = taken.abs_diff(declared);
            assert!(if ticks <= 1000 { late == 0 } else { late * 100 < declared }, "{ticks}: {taken}");
            assert!(ramp[taken..].iter().all(|part| *part == 1.0), "{ticks}");
            let even = std::iter::once(&0.0).chain(&ramp[..taken - 1]).zip(&ramp[..taken]);
            for (before, after) in even {
                assert!((0.4..1.6).contains(&((after - before) / step)), "{ticks}: {before} to {after}");
            }
        }
    }
}

/// Situation: a ramp up or down, with different durations.
/// Action: release or press half-way.
/// Must hold: the ramp continues from its present value in the steps of the new direction, the last step no longer than
/// the others.
#[test]
fn an_interrupted_ramp_continues_from_its_value() {
    for (ramp_in_ticks, ramp_out_ticks, expected) in [
        (
            2,
            4,
            &[
                (true, 0.5),
                (true, 1.0),
                (false, 0.75),
                (false, 0.5),
                (false, 0.25),
                (true, 0.75),
                (true, 1.0),
            ][..],
        ),
        (4, 2, &[(true, 0.25), (true, 0.5), (true, 0.75), (false, 0.25), (false, 0.0)]),
    ] {
        let mut bench = Bench::new();
        bench.config = EngagementConfig { ramp_in_ticks, ramp_out_ticks, ..CONFIG };
        bench.hold(&NORMAL, 20);
        for (engage, authority) in expected {
            let p = bench.step(&EngagementInput { engage: *engage, ..NORMAL });
            assert_eq!((p.authority, bench.state.authority()), (*authority, *authority), "{expected:?}");
        }
    }
}

/// Situation: all modes.
/// Action: read their names, numbers and permission.
/// Must hold: torque is permitted in two of them; names and numbers are those of the log and the wire.
#[test]
fn modes_have_names_and_numbers() {
    use Mode::*;
    let all = [Off, Initialise, SelfTest, Standby, Engaged, Limp, Fault];
    let names = ["off", "initialise", "self-test", "standby", "engaged", "limp", "fault"];
    assert_eq!(all.map(Mode::name), names);
    assert_eq!(all.map(|mode| mode as u8), [0, 1, 2, 3, 4, 5, 6]);
    assert_eq!(all.map(Mode::drives), [false, false, false, false, true, true, false]);
}

/// Situation: a sensor is missing since boot.
/// Action: wait.
/// Must hold: no fault, initialise mode, and the cause is listed.
#[test]
fn missing_at_boot_is_not_a_fault() {
    let mut bench = Bench::new();
    let p = bench.hold(&EngagementInput { causes: Causes::of(Cause::GyroLost), ..NORMAL }, 100);
    assert_eq!(p.mode, Mode::Initialise);
    assert!(p.causes.has(Cause::GyroLost) && p.causes.has(Cause::SelfTest));
}
