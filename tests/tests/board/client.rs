//! Requests and their answers.

use control::{Config, Law};
use link::frame::VERSION;
use link::message::Message;
use link::parameter_list::each;
use sim_host::board::client::{Client, ClientError, RetryPolicy};
use std::time::Duration;
use tests::link_board::{LinkBoard, LinkChannel, Wire, encoded, faults, lock, shared, telemetry};

/// Hardly any: these lines answer at once or not at all.
pub(crate) const SHORT: RetryPolicy = RetryPolicy { answer: Duration::from_millis(2), tries: 5 };

fn client(wire: Wire) -> Client {
    Client::new(Box::new(wire), SHORT)
}

/// Situation: a good line to a board with a parameter that is not at its default.
/// Action: everything that can be asked for.
/// Must hold: each answer is what the board has; what is set is there, what is stored is in the flash, cleared faults are
/// gone; one request each reaches the board, and a list takes 30 to 80.
#[test]
fn everything_asked_for_is_answered() {
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
    each(&mut config.clone(), |seen| {
        expected.push((seen.key().to_string(), seen.kind, seen.value, seen.leaf.min, seen.leaf.max));
        seen.value
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
    let kept = client.faults().expect("faults");
    let kinds: Vec<_> = kept.iter().map(|fault| (fault.kind, fault.boot)).collect();
    assert_eq!(
        kinds,
        [("controller", 5), ("brown-out", 4), ("watchdog", 3), ("exception", 2), ("panic", 1), ("drive", 1)]
    );
    client.clear_faults().expect("cleared");
    assert_eq!(client.faults().expect("none").len(), 0);
    assert_eq!(lock(&board).faults.len(), 0);
}

/// Situation: a key that is none, a value out of range, a fraction for a count, off for what can't be, a change while
/// engaged.
/// Action: ask.
/// Must hold: refused at once, naming what was asked and why; nothing changed.
#[test]
fn a_refusal_names_what_and_why() {
    let board = shared(LinkBoard::default());
    let mut client = client(Wire::good(&board));
    let mut refused = |act: &dyn Fn(&mut Client) -> Result<Option<f32>, ClientError>, named: &[&str]| {
        let before = lock(&board).requests;
        let error = act(&mut client).expect_err("refused").to_string();
        assert_eq!(lock(&board).requests, before + 1);
        assert!(named.iter().all(|word| error.contains(word)), "{error}");
        assert_eq!(lock(&board).config, Config::product());
    };
    refused(&|c| c.get("limits.nonsense"), &["get limits.nonsense", "no parameter limits.nonsense"]);
    refused(
        &|c| c.set("limits.max_torque_nm", Some(70.0)),
        &["limits.max_torque_nm = 70 is outside 0.1 to 50"],
    );
    refused(&|c| c.set("permit.ramp_in_ticks", Some(1.5)), &["not a whole number"]);
    refused(&|c| c.set("rate_hz", None), &["set rate_hz to none", "can't be off"]);
    lock(&board).engaged = true;
    refused(&|c| c.set("limits.max_torque_nm", Some(5.0)), &["refused while engaged"]);
    refused(&|c| c.store().map(|()| None), &["`store`", "refused while engaged"]);
}

/// Situation: a board of another version; one that says nothing; one whose line is lost.
/// Action: ask who is there.
/// Must hold: told which versions; that nothing answered, how often and how long; which line is lost.
#[test]
fn who_does_not_answer_is_told_why() {
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

/// Situation: a board that tells a step, words and a fault before each answer.
/// Action: ask some things; then listen.
/// Must hold: the answers are right; everything told is there once, in its order.
#[test]
fn what_comes_unasked_meanwhile_is_kept() {
    let board = shared(LinkBoard::default());
    let (teller, mut steps) = (board.clone(), 0);
    let also = move |answer: Vec<u8>| {
        steps += 1;
        let mut teller = lock(&teller);
        let mut bytes = teller.tell(&Message::Telemetry(telemetry(steps)));
        bytes.extend(teller.tell(&Message::Log("words")));
        bytes.extend(teller.tell(&Message::Fault(faults()[0])));
        LinkChannel::Arrives([bytes, answer].concat())
    };
    let mut client = client(Wire::new(&board, Box::new(LinkChannel::Arrives), Box::new(also)));
    for _ in 0..3 {
        assert_eq!(client.get("rate_hz").expect("a value"), Some(1000.0));
    }
    let received = client.listen(Duration::ZERO).expect("kept");
    assert_eq!(received.iter().map(|one| one.sequence).collect::<Vec<_>>(), (0..9).collect::<Vec<_>>());
    let steps = received.iter().filter_map(|one| match one.message() {
        Ok(Message::Telemetry(step)) => Some(step.steps),
        _ => None,
    });
    assert_eq!(steps.collect::<Vec<_>>(), [1, 2, 3]);
    assert!(client.listen(Duration::ZERO).expect("nothing more").is_empty());
}

/// Situation: before each answer the line brings answers to other programs, of every number but the right one.
/// Action: ask.
/// Must hold: they are passed over.
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
