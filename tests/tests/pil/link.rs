//! Faults of the loop's link: as text, and their effects.

use control::{Mode, SensorFrame, State, step};
use proptest::prelude::*;
use proptest::sample::select;
use sim_host::pil::{Controller, Direction, LinkFault, LinkFaultKind, Lockstep};
use sim_host::ride::{Assist, Conditions, Stepped};
use tests::draws::runner;
use tests::fake_board::{FakeBoard, aged};
use tests::pil::{KNOCK, Ridden, link_faults, product, ridden};

/// Situation: any fault of the link. Action: write it, read it back. Must hold: the same.
#[test]
fn a_written_link_fault_reads_back() {
    let kinds = prop_oneof![
        Just(LinkFaultKind::Drop),
        Just(LinkFaultKind::Corrupt),
        (1..=1000u32).prop_map(LinkFaultKind::Late)
    ];
    let when = (0.0..3000.0, prop_oneof![Just(f64::INFINITY), 0.001..600.0]);
    let faults = (select(&Direction::ALL), kinds, when).prop_map(|(direction, kind, (from_s, long))| {
        LinkFault { direction, kind, from_s, to_s: from_s + long }
    });
    runner(1000)
        .run(&faults, |fault| {
            let text = fault.to_string();
            prop_assert_eq!(text.parse::<LinkFault>(), Ok(fault), "{}", text);
            Ok(())
        })
        .unwrap();
}

/// Situation: texts that are no fault of the link.
/// Action: read them.
/// Must hold: rejected, naming the text and the allowed ones.
#[test]
fn invalid_link_faults_are_named() {
    for (text, named) in [
        ("drop@1s", "DIRECTION:FAULT"),
        ("gyro:drop", "sensors or motor"),
        ("sensors:lost", "drop, late=TIME or corrupt"),
        ("sensors:late", "late=TIME"),
        ("sensors:drop=3ms", "no value"),
        ("sensors:late=3", "unit"),
        ("sensors:late=0ms", "1 ms"),
        ("sensors:late=2.5ms", "whole number"),
        ("motor:late=2s", "0 s to 1 s"),
        ("motor:drop@2s..1s", "not after 2 s"),
        ("motor:drop@4000s", "3600"),
    ] {
        let why = text.parse::<LinkFault>().expect_err(text);
        assert!(why.to_string().contains(text) && why.to_string().contains(named), "{why}");
    }
}

/// The flashed controller's answers if only the frames of `arrived` arrive, each at the step it names.
fn expected(
    conditions: &Conditions,
    frames: &[SensorFrame],
    arrived: impl Fn(usize) -> Option<usize>,
) -> Vec<Stepped> {
    let Assist::Firmware(plan) = &conditions.assist else { unreachable!() };
    let (mut state, mut newest) = (State::default(), 0);
    let mut one = |k: usize| {
        newest = arrived(k).unwrap_or(newest);
        let command = step(plan, &mut state, &aged(&frames[newest], (k - newest) as u16));
        Stepped { command, authority: state.authority() }
    };
    (0..frames.len()).map(&mut one).collect()
}

/// Situation: a product ride with a noisy gyro.
/// Action: sensor frames are dropped, damaged, or late by 3 ms, from 0.2 s to 0.25 s.
/// Must hold: each command is that of the last frame received, older by its delay in ticks; dropped and damaged ones
/// are the same; the ride differs from the undisturbed one; as many steps are reported as affected.
pub(crate) fn sensors_lost_and_late<B: Lockstep>(mut board: impl FnMut() -> B) {
    let mut conditions = Conditions { time_limit_s: 0.8, ..product() };
    conditions.plant.sensors.model_mut(sim_host::plant::Sensor::Gyro).noise = 0.02;
    let mut ride = |fault: &str| {
        let mut controller = Controller::new(board(), &link_faults(&[fault]), 7);
        let ridden = ridden(&conditions, KNOCK, &mut controller).unwrap();
        assert_eq!(controller.tally().affected, 50, "{fault}");
        ridden
    };
    let fault = |kind: &str| format!("sensors:{kind}@0.2s..0.25s");
    let [dropped, damaged, late] = ["drop", "corrupt", "late=3ms"].map(|kind| ride(&fault(kind)));
    let boot = dropped.steps.len() - dropped.trace.len();
    let (from, to) = (boot + 200, boot + 250);
    let answers = |ridden: &Ridden| ridden.steps.iter().map(|(_, stepped)| *stepped).collect::<Vec<_>>();
    let frames = |ridden: &Ridden| ridden.steps.iter().map(|(frame, _)| *frame).collect::<Vec<_>>();
    let lost = |k: usize| (!(from..to).contains(&k)).then_some(k);
    assert!(answers(&dropped) == expected(&conditions, &frames(&dropped), lost));
    assert!(damaged.bits() == dropped.bits());
    let delayed = |k: usize| match k {
        _ if k < from || k >= to => Some(k),
        _ if k < from + 3 => None,
        _ => Some(k - 3),
    };
    assert!(answers(&late) == expected(&conditions, &frames(&late), delayed));
    assert!(late.bits() != dropped.bits());
    let all = |k: usize| Some(k);
    assert!(answers(&dropped) != expected(&conditions, &frames(&dropped), all));
}

/// Situation: a product ride that engages.
/// Action: its commands are dropped, damaged, or late by 2 ms, from 0.2 s to 0.25 s.
/// Must hold: dropped and damaged, the motor holds the last command for 5 ms and then gives no torque until the next
/// one; late, it executes the command of 2 ms before.
pub(crate) fn commands_lost_and_late<B: Lockstep>(mut board: impl FnMut() -> B) {
    let conditions = Conditions { time_limit_s: 0.4, ..product() };
    let mut ride = |fault: &str| {
        let mut controller = Controller::new(board(), &link_faults(&[fault]), 7);
        ridden(&conditions, KNOCK, &mut controller).unwrap()
    };
    let fault = |kind: &str| format!("motor:{kind}@0.2s..0.25s");
    let [dropped, damaged, late] = ["drop", "corrupt", "late=2ms"].map(|kind| ride(&fault(kind)));
    let boot = dropped.steps.len() - dropped.trace.len();
    let (from, to) = (boot + 200, boot + 250);
    assert!(damaged.bits() == dropped.bits());
    let before = dropped.steps[from - 1].1;
    assert!(before.command.torque_nm != 0.0 && before.command.mode == Mode::Engaged);
    for k in from..to {
        let held = k < from + 5;
        assert_eq!(dropped.steps[k].1, if held { before } else { Stepped::OFF }, "step {k}");
    }
    assert!(dropped.steps[to].1.command.torque_nm != 0.0);
    let Assist::Firmware(plan) = &conditions.assist else { unreachable!() };
    let mut state = State::default();
    let requested: Vec<f32> =
        late.steps.iter().map(|(frame, _)| step(plan, &mut state, frame).torque_nm).collect();
    let given = |k: usize| late.steps[k].1.command.torque_nm;
    for k in from - 50..to + 50 {
        let of = match k {
            _ if k < from || k >= to => k,
            _ if k < from + 2 => from - 1,
            _ => k - 2,
        };
        assert_eq!(given(k).to_bits(), requested[of].to_bits(), "step {k}");
    }
}

/// As of [`sensors_lost_and_late`], on the fake board.
#[test]
fn sensors_lost_and_late_on_the_fake_board() {
    sensors_lost_and_late(FakeBoard::default);
}

/// As of [`commands_lost_and_late`], on the fake board.
#[test]
fn commands_lost_and_late_on_the_fake_board() {
    commands_lost_and_late(FakeBoard::default);
}
