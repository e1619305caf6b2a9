//! Requests and their answers.

use control::{Config, Law};
use link::frame::VERSION;
use link::message::Message;
use link::parameter_list::each;
use sim_host::board::client::{Client, ClientError, RetryPolicy};
use std::time::Duration;
use tests::link_board::{LinkBoard, LinkChannel, Wire, encoded, faults, lock, shared, telemetry};

/// Short, as these connections answer at once or never.
pub(crate) const SHORT: RetryPolicy = RetryPolicy { answer: Duration::from_millis(2), tries: 5 };

fn client(wire: Wire) -> Client {
    Client::new(Box::new(wire), SHORT)
}

/// Situation: a good connection to a board with a parameter that is not at its default.
/// Action: send every request.
/// Must hold: each answer has the board's values; a set value is set, a stored one is in the flash, cleared faults
/// are gone; one request each reaches the board, and a list takes 30 to 80.
#[test]
fn every_request_is_answered() {
    let mut config = Config::product();
    config.limits.max_torque_nm = Some(3.5);
    let board = shared(LinkBoard { config: config.clone(), faults: faults(), ..LinkBoard::default() });
    let mut client = client(Wire::good(&board));
    let hello = client.hello().expect("an answer");
    assert_eq!((hello.image.as_str(), hello.commit.as_str()), ("fake", "0123456789ab"));
    assert_eq!(hello.configuration, format!("{:08x}", link::report::config_hash(&config)));
    let listed = client.list().expect("a list");
    assert!((30..=80).contains(&lock(&board).requests), "{}", lock(&board).requests);
    let mut expected = Vec::new();
    each(&mut config.clone(), |parameter| {
        expected.push((
            parameter.key().to_string(),
            parameter.kind,
            parameter.value,
            parameter.leaf.min,
            parameter.leaf.max,
        ));
        parameter.value
    });
    let got = listed.iter().map(|one| (one.key.clone(), one.kind, one.value, one.min, one.max));
    assert_eq!(got.collect::<Vec<_>>(), expected);
    let before = lock(&board).requests;
    assert_eq!(client.get("limits.max_torque_nm").expect("a value"), Some(3.5));
    assert_eq!(client.set("limits.max_torque_nm", Some(4.0)).expect("set"), Some(4.0));
    assert_eq!(client.set_law(&Law::Cl2 { k: 3.0 }).expect("set"), Law::Cl2 { k: 3.0 });
    assert_eq!(client.law().expect("a law"), Law::Cl2 { k: 3.0 });
    client.store().expect("stored");
    let stored = lock(&board).stored.clone().expect("in flash");
    assert_eq!((stored.limits.max_torque_nm, stored.law), (Some(4.0), Law::Cl2 { k: 3.0 }));
    client.reset().expect("reset");
    assert_eq!(lock(&board).config, Config::product());
    assert_eq!(lock(&board).requests - before, 6);
    let stored = client.faults().expect("faults");
    let kinds: Vec<_> = stored.iter().map(|fault| (fault.kind, fault.boot)).collect();
    assert_eq!(
        kinds,
        [("controller", 5), ("brown-out", 4), ("watchdog", 3), ("exception", 2), ("panic", 1), ("drive", 1)]
    );
    client.clear_faults().expect("cleared");
    assert_eq!(client.faults().expect("none").len(), 0);
    assert_eq!(lock(&board).faults.len(), 0);
}

/// Situation: an unknown key, a value out of range, a fraction for a count, off for a parameter that cannot be off, a
/// change while engaged.
/// Action: send.
/// Must hold: rejected at once, naming the request and the reason; nothing changed.
#[test]
fn a_rejection_names_request_and_reason() {
    let board = shared(LinkBoard::default());
    let mut client = client(Wire::good(&board));
    let mut assert_rejected = |act: &dyn Fn(&mut Client) -> Result<Option<f32>, ClientError>,
                               named: &[&str]| {
        let before = lock(&board).requests;
        let error = act(&mut client).expect_err("refused").to_string();
        assert_eq!(lock(&board).requests, before + 1);
        assert!(named.iter().all(|word| error.contains(word)), "{error}");
        assert_eq!(lock(&board).config, Config::product());
    };
    assert_rejected(&|c| c.get("limits.nonsense"), &["get limits.nonsense", "no parameter limits.nonsense"]);
    assert_rejected(
        &|c| c.set("limits.max_torque_nm", Some(70.0)),
        &["limits.max_torque_nm = 70 is outside 0.1 to 50"],
    );
    assert_rejected(&|c| c.set("permit.ramp_in_ticks", Some(1.5)), &["not a whole number"]);
    assert_rejected(&|c| c.set("rate_hz", None), &["set rate_hz to none", "can't be off"]);
    lock(&board).engaged = true;
    assert_rejected(&|c| c.set("limits.max_torque_nm", Some(5.0)), &["rejected while engaged"]);
    assert_rejected(&|c| c.store().map(|()| None), &["`store`", "rejected while engaged"]);
}

/// Situation: a board of another version; one that does not answer; one whose connection is lost.
/// Action: request the identity.
/// Must hold: the error has both versions; the attempts and the time without an answer; the lost line.
#[test]
fn a_missing_answer_has_its_reason() {
    let board = shared(LinkBoard { version: 7, ..LinkBoard::default() });
    let error = client(Wire::good(&board)).hello().expect_err("another version").to_string();
    let versions = format!("uses version 7 of the link, this program version {VERSION}:");
    assert!(error.contains(&versions), "{error}");
    let board = shared(LinkBoard::default());
    let mute =
        Wire::new(&board, Box::new(LinkChannel::Arrives), Box::new(|_| LinkChannel::Arrives(Vec::new())));
    let error = client(mute).hello().expect_err("mute");
    assert!(error.leaves_doubt());
    assert_eq!(lock(&board).requests, SHORT.tries);
    let text = error.to_string();
    assert!(text.contains("`hello`") && text.contains("5 times, 0.002 s"), "{text}");
    let lost = Wire::new(&board, Box::new(|_| LinkChannel::Lost), Box::new(LinkChannel::Arrives));
    let error = client(lost).hello().expect_err("lost").to_string();
    assert!(error.contains("lost wire"), "{error}");
}

/// Situation: a board that sends a step, a log text and a fault before each answer.
/// Action: send some requests; then listen.
/// Must hold: the answers are right; every unsolicited message is there once, in order.
#[test]
fn unsolicited_messages_are_preserved() {
    let board = shared(LinkBoard::default());
    let (sender, mut steps) = (board.clone(), 0);
    let also = move |answer: Vec<u8>| {
        steps += 1;
        let mut sender = lock(&sender);
        let mut bytes = sender.unsolicited(&Message::Telemetry(telemetry(steps)));
        bytes.extend(sender.unsolicited(&Message::Log("text")));
        bytes.extend(sender.unsolicited(&Message::Fault(faults()[0])));
        LinkChannel::Arrives([bytes, answer].concat())
    };
    let mut client = client(Wire::new(&board, Box::new(LinkChannel::Arrives), Box::new(also)));
    for _ in 0..3 {
        assert_eq!(client.get("rate_hz").expect("a value"), Some(1000.0));
    }
    let received = client.listen(Duration::ZERO).expect("stored");
    assert_eq!(received.iter().map(|one| one.sequence).collect::<Vec<_>>(), (0..9).collect::<Vec<_>>());
    let steps = received.iter().filter_map(|one| match one.message() {
        Ok(Message::Telemetry(step)) => Some(step.steps),
        _ => None,
    });
    assert_eq!(steps.collect::<Vec<_>>(), [1, 2, 3]);
    assert!(client.listen(Duration::ZERO).expect("nothing more").is_empty());
}

/// Situation: before each answer come answers to other programs, with every sequence number but the right one.
/// Action: send a request.
/// Must hold: they are skipped.
#[test]
fn answers_to_others_are_passed_over() {
    let board = shared(LinkBoard::default());
    let others = |answer: Vec<u8>| {
        let mut decoder = link::Decoder::default();
        let right = answer.iter().find_map(|byte| match decoder.feed(*byte) {
            Some(link::Received::Frame(frame)) => Some(frame.sequence),
            _ => None,
        });
        let right = right.expect("an answer");
        let of = |by: u16| {
            let value = Message::Value { key: link::Key::whole("rate_hz"), value: Some(f32::from(by)) };
            encoded(&value, right.wrapping_add(by))
        };
        LinkChannel::Arrives([of(1), of(u16::MAX), of(7), answer].concat())
    };
    let mut client = client(Wire::new(&board, Box::new(LinkChannel::Arrives), Box::new(others)));
    assert_eq!(client.get("rate_hz").expect("a value"), Some(1000.0));
}
