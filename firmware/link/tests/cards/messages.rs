//! Encoding and decoding of every message.

use control::wire::{decode_frame, encode_command, encode_frame};
use control::{ActiveLimits, CAUSES, Causes, Command, Mode, Sample, SensorFrame};
use link::Key;
use link::bytes::Writer;
use link::frame::{Decoder, Frame, MAX_FRAME, MAX_PAYLOAD, Received, VERSION};
use link::message::{Message, NoMessage};
use link::page::Page;
use link::rejection::{RejectReason, Rejection};
use link::report::{
    FAULT_BYTES, FAULT_TEXT_BYTES, FaultKind, FaultRecord, Hello, ResetCause, StoredFault, config_hash,
};
use link::requests::request;
use link::telemetry::Telemetry;
use proptest::prelude::*;

const MODES: [Mode; 7] = {
    use Mode::*;
    [Off, Initialise, SelfTest, Standby, Engaged, Limp, Fault]
};

/// Sends a message and passes the received one to `check`; returns its sequence number.
fn through(message: &Message<'_>, check: impl FnOnce(&Message<'_>)) -> u16 {
    let (mut bytes, mut decoder) = ([0; MAX_FRAME], Decoder::default());
    let used = message.encode(513, &mut bytes).expect("room");
    for byte in &bytes[..used - 1] {
        assert_eq!(decoder.feed(*byte), None);
    }
    match decoder.feed(0) {
        Some(Received::Frame(frame)) => {
            assert_eq!(frame.kind, message.kind());
            check(&Message::decode(&frame).expect("a message"));
            frame.sequence
        }
        other => panic!("{other:?}"),
    }
}

fn commands() -> impl Strategy<Value = Command> {
    let numbers = (-50.0_f32..50.0, -200.0_f32..200.0);
    (numbers, any::<u16>(), 0..MODES.len(), any::<u64>()).prop_map(
        |((torque_nm, gain_nm_s_rad), limits, mode, causes)| {
            let (limits, mode, causes) = (ActiveLimits(limits), MODES[mode], Causes(causes));
            Command { torque_nm, gain_nm_s_rad, limits, mode, causes }
        },
    )
}

fn slopes() -> impl Strategy<Value = [Option<f32>; 2]> {
    prop::array::uniform2(prop::option::of(-2.0_f32..2.0))
}

proptest! {
    /// Situation: any sensor frame's bits, any command, any slopes.
    /// Action: send telemetry and the frames of processor in the loop.
    /// Must hold: every bit is the same.
    #[test]
    fn frame_command_and_slopes_are_sent_bit_by_bit(
        bits in prop::collection::vec(any::<u8>(), 81), command in commands(), slopes in slopes(), steps in any::<u32>()
    ) {
        let frame = decode_frame(&bits.try_into().expect("81 bytes"));
        let sent = Telemetry { steps, late: 3, driven: true, frame, command, slopes, polarity: 2, polarity_torque_nm: 1.5 };
        through(&Message::Telemetry(sent), |got| {
            let Message::Telemetry(got) = got else { panic!("{got:?}") };
            assert_eq!(encode_frame(&got.frame), encode_frame(&frame));
            assert_eq!(encode_command(&got.command), encode_command(&command));
            assert_eq!((got.steps, got.late, got.driven, got.slopes), (steps, 3, true, slopes));
            assert_eq!((got.polarity, got.polarity_torque_nm), (2, 1.5));
        });
        through(&Message::PilFrame(frame), |got| {
            let Message::PilFrame(got) = got else { panic!("{got:?}") };
            assert_eq!(encode_frame(got), encode_frame(&frame));
        });
        let message = Message::PilCommand { command, authority: 0.25 };
        through(&message, |got| assert_eq!(*got, message));
    }

    /// Situation: a frame of any kind with any payload.
    /// Action: decode it as a message, and as a page's entries; encode the result.
    /// Must hold: no panic; a decoded message can be encoded.
    #[test]
    fn any_payload_is_a_message_or_rejected(
        kind in any::<u8>(), payload in prop::collection::vec(any::<u8>(), 0..=MAX_PAYLOAD)
    ) {
        let frame = Frame { kind, sequence: 0, payload: &payload };
        match Message::decode(&frame) {
            Ok(message) => {
                if let Message::Page(page) = message {
                    prop_assert!(page.entries().count() <= usize::from(page.count));
                }
                prop_assert!(message.encode(0, &mut [0; MAX_FRAME]).is_some());
            }
            Err(error) => prop_assert!(error == NoMessage::UnknownKind(kind) || error == NoMessage::Malformed(kind)),
        }
    }
}

/// Every message with a non-zero value in each field.
pub(crate) fn all() -> Vec<Message<'static>> {
    let parted = Key { group: "limits.end_stop", name: "soft_rad" };
    let rejection =
        Rejection { reason: RejectReason::OutOfRange, key: parted, value: 9.0, min: 0.5, max: 1.5 };
    let hello =
        Hello { image: "board-vesc6", version: "0.1.0", commit: "0123456789ab", config_hash: 0xdead_beef };
    let fault = FaultRecord {
        kind: FaultKind::Exception,
        boot: 12,
        reset: ResetCause::Watchdog,
        mode: Mode::Limp,
        steps: 77,
        frame_us: 123_456_789,
        causes: Causes::all(&CAUSES),
        exception: 3,
        registers: [1, 2, 3, 4, 5, 6],
        text: "bus fault",
    };
    let (torque_nm, gain_nm_s_rad) = (1.5, -2.5);
    let command =
        Command { torque_nm, gain_nm_s_rad, limits: ActiveLimits::RATE, mode: Mode::Limp, causes: Causes(6) };
    vec![
        Message::AskHello,
        Message::List { from: 300 },
        Message::Get { key: parted },
        Message::Set { key: parted, value: None },
        Message::Set { key: parted, value: Some(1.25) },
        Message::GetLaw,
        Message::SetLaw(&[1, 2, 3]),
        Message::Store,
        Message::Reset,
        Message::ListFaults { from: 3 },
        Message::ClearFaults,
        Message::PilReset,
        Message::Hello(hello),
        Message::Page(Page { from: 1, total: 2, count: 0, bytes: &[] }),
        Message::Value { key: parted, value: Some(-0.0) },
        Message::Law(&[0, 0, 0]),
        Message::Done,
        Message::Rejected(rejection),
        Message::WrongVersion { theirs: 9 },
        Message::StoredFault(StoredFault { place: 1, total: 2, record: Some(fault) }),
        Message::StoredFault(StoredFault { place: 2, total: 2, record: None }),
        Message::PilFrame(SensorFrame::missing()),
        Message::PilCommand { command, authority: 0.5 },
        Message::PilConfig { at: 512, bytes: &[9, 8, 7] },
        Message::Telemetry(Telemetry {
            steps: 5,
            late: 0,
            driven: false,
            frame: SensorFrame::missing(),
            command,
            slopes: [None, Some(0.5)],
            polarity: 1,
            polarity_torque_nm: -2.0,
        }),
        Message::Fault(fault),
        Message::Log("steer sensor found; 7 \u{b5}s"),
    ]
}

/// Situation: every message.
/// Action: encode and decode; then with a byte more, and with one less than it needs.
/// Must hold: the same message and number; extra bytes change nothing; too few are rejected.
#[test]
fn every_message_is_decoded_as_encoded() {
    for message in all() {
        assert_eq!(through(&message, |got| assert_eq!(*got, message)), 513);
        let mut bytes = [0; MAX_FRAME];
        let used = message.encode(513, &mut bytes).expect("room");
        let mut plain = [0; MAX_FRAME];
        let length = cobs::decode(&bytes[1..used], &mut plain).expect("stuffed").frame_size();
        let payload = &plain[4..length - 4];
        let of = |payload| Message::decode(&Frame { kind: message.kind(), sequence: 0, payload });
        let raw = matches!(
            message,
            Message::SetLaw(_)
                | Message::Law(_)
                | Message::Log(_)
                | Message::Page(_)
                | Message::PilConfig { .. }
        );
        if !raw && !payload.is_empty() {
            assert_eq!(of(&plain[4..length - 3]), Ok(message), "one more");
            let less = of(&payload[..payload.len() - 1]);
            assert!(matches!(less, Err(NoMessage::Malformed(kind)) if kind == message.kind()), "{less:?}");
        }
    }
}

/// Situation: a later board of this version: causes 60, 63, 64 and 127 beside those of today, and the sample of one more
/// sensor at the end of its frame.
/// Action: decode its telemetry, its sensor frame and its command as today's program does, and encode the result.
/// Must hold: every field of today is the same; causes up to 63 are there, and come through again; causes from 64 on are
/// left out and change no other field.
#[test]
fn a_sensor_can_be_added() {
    const CAUSES_AT: usize = 4 + 4 + 1 + 4 + 4 + 2 + 1;
    let Some(Message::Telemetry(today)) = all().into_iter().find(|m| matches!(m, Message::Telemetry(_)))
    else {
        panic!("no telemetry")
    };
    let frame = SensorFrame { steer_rad: Sample { value: 0.25, age_ticks: 3 }, engage: true, ..today.frame };
    let today = Telemetry { frame, ..today };
    let mut bytes = [0; MAX_PAYLOAD];
    let mut writer = Writer::new(&mut bytes);
    today.encode(&mut writer);
    writer.put(&[0, 0, 0x80, 0x3f, 0, 0]);
    let used = writer.used().expect("room");
    let known = u128::from(today.command.causes.0);
    let reported = known | 1 << 60 | 1 << 63 | 1 << 64 | 1 << 127;
    bytes[CAUSES_AT..][..16].copy_from_slice(&reported.to_le_bytes());
    let of = |kind, payload| Message::decode(&Frame { kind, sequence: 0, payload }).expect("a message");

    let causes = Causes(today.command.causes.0 | 1 << 60 | 1 << 63);
    let command = Command { causes, ..today.command };
    let received = Telemetry { command, ..today };
    assert_eq!(of(0xa0, &bytes[..used]), Message::Telemetry(received));
    through(&Message::Telemetry(received), |got| assert_eq!(*got, Message::Telemetry(received)));

    assert_eq!(of(0x11, &bytes[used - 6 - 81..used]), Message::PilFrame(frame));
    let mut answer = encode_command(&today.command).to_vec();
    answer[CAUSES_AT - 9..].copy_from_slice(&reported.to_le_bytes());
    answer.extend(0.5_f32.to_le_bytes());
    assert_eq!(of(0x91, &answer), Message::PilCommand { command, authority: 0.5 });
}

/// Situation: every reason, mode, fault kind and reset cause, and numbers beyond them.
/// Action: convert to its number and back.
/// Must hold: the same; none for the numbers beyond.
#[test]
fn every_number_means_one_thing() {
    for number in 0..=255 {
        assert_eq!(
            RejectReason::numbered(number).map(|why| why as u8),
            (1..=11).contains(&number).then_some(number)
        );
        assert_eq!(
            Mode::numbered(number).map(|mode| mode as u8),
            (0..=6).contains(&number).then_some(number)
        );
        assert_eq!(
            FaultKind::numbered(number).map(|kind| kind as u8),
            (1..=6).contains(&number).then_some(number)
        );
        assert_eq!(
            ResetCause::numbered(number).map(|cause| cause as u8),
            (0..=6).contains(&number).then_some(number)
        );
    }
}

/// Situation: a frame of another version; of a kind that does not exist; of a kind that is too short; a good one.
/// Action: decode them as requests.
/// Must hold: each but the good one is answered with its error, under its sequence number where known.
#[test]
fn an_invalid_request_is_answered() {
    let rejected = |why| Message::Rejected(Rejection::of(why));
    let of = |kind, payload| Received::Frame(Frame { kind, sequence: 44, payload });
    for (received, answer) in [
        (Received::WrongVersion { theirs: VERSION + 1 }, (0, Message::WrongVersion { theirs: VERSION + 1 })),
        (of(0x7f, &[][..]), (44, rejected(RejectReason::UnknownRequest))),
        (of(0x02, &[1]), (44, rejected(RejectReason::Malformed))),
        (of(0x03, &[2, 0xff, 0xff]), (44, rejected(RejectReason::Malformed))),
    ] {
        assert_eq!(request(&received).expect_err("no request").answer(), answer);
    }
    assert_eq!(request(&of(0x02, &[1, 0])), Ok((44, Message::List { from: 1 })));
}

/// Situation: a text longer than a frame, of two-byte characters.
/// Action: send it as a log line and as a fault's text.
/// Must hold: its beginning arrives, cut between characters.
#[test]
fn long_texts_are_cut_between_characters() {
    let long = "\u{e9}".repeat(400);
    through(&Message::Log(&long), |got| assert_eq!(*got, Message::Log(&long[..MAX_PAYLOAD])));
    through(&Message::Fault(panic_of(&long)), |got| {
        assert_eq!(*got, Message::Fault(panic_of(&long[..FAULT_TEXT_BYTES])))
    });
}

fn panic_of(text: &str) -> FaultRecord<'_> {
    FaultRecord {
        kind: FaultKind::Panic,
        boot: 1,
        reset: ResetCause::PowerOn,
        mode: Mode::Off,
        steps: 0,
        frame_us: 0,
        causes: Causes::NONE,
        exception: 0,
        registers: [0; 6],
        text,
    }
}

/// Situation: a fault record with the longest text.
/// Action: store it, and send it.
/// Must hold: its size is the documented one, and it fits into a frame with its index.
#[test]
fn the_largest_fault_record_has_its_size() {
    let text = "x".repeat(FAULT_TEXT_BYTES);
    let stored = StoredFault { place: 0, total: 1, record: Some(panic_of(&text)) };
    let mut bytes = [0; MAX_FRAME];
    let used = Message::StoredFault(stored).encode(1, &mut bytes).expect("room");
    let plain = cobs::decode(&bytes[1..used], &mut [0; MAX_FRAME]).expect("stuffed").frame_size();
    assert_eq!(plain - 8, 4 + FAULT_BYTES);
    assert!((200..=300).contains(&(4 + FAULT_BYTES)));
    through(&Message::StoredFault(stored), |got| assert_eq!(*got, Message::StoredFault(stored)));
}

/// Situation: two configurations that differ in one parameter.
/// Action: compute their hashes.
/// Must hold: they differ, and are reproducible.
#[test]
fn the_configuration_has_a_hash() {
    let mut other = control::Config::product();
    other.permit.ramp_in_ticks += 1;
    let hash = config_hash(&control::Config::product());
    assert_ne!(hash, config_hash(&other));
    assert_eq!(hash, config_hash(&control::Config::product()));
}
