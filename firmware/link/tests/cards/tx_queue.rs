//! The transmit queue under overload.

use control::{ActiveLimits, Causes, Command, Mode, SensorFrame};
use link::frame::{Decoder, MAX_FRAME, Received};
use link::message::Message;
use link::telemetry::Telemetry;
use link::{Key, TxQueue};
use proptest::prelude::*;

fn telemetry(steps: u32) -> Telemetry {
    let command = Command {
        torque_nm: 0.0,
        gain_nm_s_rad: 0.0,
        limits: ActiveLimits::default(),
        mode: Mode::Standby,
        causes: Causes::NONE,
    };
    Telemetry {
        steps,
        late: 0,
        driven: false,
        frame: SensorFrame::missing(),
        command,
        slopes: [None, Some(0.9)],
        polarity: 0,
        polarity_torque_nm: 0.0,
    }
}

/// Removes up to a number of bytes; returns numbers and kinds of the completed frames.
fn drain<const A: usize, const U: usize>(
    sender: &mut TxQueue<A, U>,
    decoder: &mut Decoder,
    bytes: usize,
) -> Vec<(u16, u8)> {
    let mut got = Vec::new();
    for _ in 0..bytes {
        let Some(byte) = sender.next_byte() else { break };
        if let Some(Received::Frame(frame)) = decoder.feed(byte) {
            got.push((frame.sequence, frame.kind));
        }
    }
    got
}

/// Situation: a line without a limit; telemetry of one step of 20, of every step, of none.
/// Action: 1000 steps.
/// Must hold: 50 frames, the first step's among them; 1000; none.
#[test]
fn every_nth_step_is_sent() {
    for (divisor, expected) in [(20, 50), (1, 1000), (0, 0), (u16::MAX, 1)] {
        let (mut sender, mut decoder) = (TxQueue::<256, 512>::new(divisor), Decoder::default());
        let mut sent = 0;
        for steps in 1..=1000 {
            sender.step(&telemetry(steps));
            sent += drain(&mut sender, &mut decoder, usize::MAX).len();
        }
        assert_eq!((sent, sender.dropped()), (expected, 0), "{divisor}");
    }
}

/// Situation: a line of 47 bytes per step, with telemetry at every step: a third of the required rate.
/// Action: 3000 steps, then drain the queue.
/// Must hold: nothing blocks; every frame arrived complete or was counted as dropped, and the sequence numbers show
/// which; a third arrived.
#[test]
fn telemetry_is_dropped_whole_and_counted() {
    let (mut sender, mut decoder) = (TxQueue::<256, 512>::new(1), Decoder::default());
    let mut got = Vec::new();
    for steps in 1..=3000 {
        sender.step(&telemetry(steps));
        got.extend(drain(&mut sender, &mut decoder, 47));
    }
    got.extend(drain(&mut sender, &mut decoder, usize::MAX));
    assert_eq!(decoder.dropped(), Default::default());
    assert_eq!(got.len() + sender.dropped() as usize, 3000);
    assert!(got.windows(2).all(|two| two[0].0 < two[1].0));
    assert!((900..=1100).contains(&got.len()), "{}", got.len());
}

/// Situation: the ring of unsolicited messages is full, and one of its frames is half sent.
/// Action: answer a request.
/// Must hold: the answer fits; it is sent right after that frame, under the request's number.
#[test]
fn an_answer_overtakes_telemetry() {
    let (mut sender, mut decoder) = (TxQueue::<256, 512>::new(1), Decoder::default());
    for steps in 1..=10 {
        sender.step(&telemetry(steps));
    }
    assert!(sender.dropped() > 0);
    assert_eq!(drain(&mut sender, &mut decoder, 30), vec![]);
    assert!(sender.answer(&Message::Value { key: Key::whole("rate_hz"), value: Some(1000.0) }, 4711));
    let got = drain(&mut sender, &mut decoder, usize::MAX);
    assert_eq!(got[..2], [(0, 0xa0), (4711, 0x83)]);
    assert!(got.len() > 3 && got[2..].iter().all(|(_, kind)| *kind == 0xa0), "{got:?}");
}

/// Situation: more answers than fit.
/// Action: answer until rejected; send; answer again.
/// Must hold: rejected, not cut, and nothing counted as dropped; then answers fit again; all accepted ones arrive.
#[test]
fn an_answer_without_room_is_rejected() {
    let (mut sender, mut decoder) = (TxQueue::<64, 512>::new(1), Decoder::default());
    let taken = (0..20).filter(|sequence| sender.answer(&Message::Done, *sequence)).count();
    assert_eq!(taken, 64 / 11);
    let got = drain(&mut sender, &mut decoder, usize::MAX);
    assert_eq!(got, (0..taken as u16).map(|sequence| (sequence, 0x85)).collect::<Vec<_>>());
    assert!(sender.answer(&Message::Done, 99));
    assert_eq!(sender.dropped(), 0);
    assert!(!sender.answer(&Message::Log(&"x".repeat(60)), 1));
}

proptest! {
    /// Situation: any order of answers, steps, log texts and bytes sent.
    /// Action: all of it; then drain.
    /// Must hold: no panic; every accepted frame arrives complete, answers in order.
    #[test]
    fn every_accepted_frame_arrives(acts in prop::collection::vec((0..4_u8, 0..200_usize), 1..200)) {
        let (mut sender, mut decoder) = (TxQueue::<{ MAX_FRAME }, 400>::new(1), Decoder::default());
        let (mut answers, mut sent, mut got) = (Vec::new(), 0, Vec::new());
        for (i, (act, size)) in acts.into_iter().enumerate() {
            match act {
                0 if sender.answer(&Message::Law(&vec![0; size]), i as u16) => answers.push(i as u16),
                0 => {}
                1 => sender.step(&telemetry(i as u32)),
                2 => sender.send(&Message::Log(&"0".repeat(size))),
                _ => got.extend(drain(&mut sender, &mut decoder, size)),
            }
            sent += u32::from(act == 1 || act == 2);
        }
        got.extend(drain(&mut sender, &mut decoder, usize::MAX));
        prop_assert_eq!(decoder.dropped(), Default::default());
        let arrived: Vec<_> = got.iter().filter(|(_, kind)| *kind == 0x84).map(|(sequence, _)| *sequence).collect();
        prop_assert_eq!(arrived.len() as u32 + sent - sender.dropped(), got.len() as u32);
        prop_assert_eq!(arrived, answers);
    }
}
