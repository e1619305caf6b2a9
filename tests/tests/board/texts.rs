//! Parameters, causes, limits and exceptions as text.

use crate::client::SHORT;
use control::{ActiveLimits, CAUSES, Causes};
use link::parameter_list::Kind;
use proptest::prelude::*;
use sim_host::board::causes::{limits, named};
use sim_host::board::exception::Exception;
use sim_host::board::fault::Fault;
use sim_host::board::parameter::Parameter;
use sim_host::board::{Client, causes};
use std::collections::BTreeSet;
use tests::cli::repository;
use tests::link_board::{LinkBoard, Wire, faults, shared};

fn listed() -> Vec<Parameter> {
    Client::new(Box::new(Wire::good(&shared(LinkBoard::default()))), SHORT).list().expect("a list")
}

/// Situation: every parameter of a board.
/// Action: its value, its default, its limits and off as text, and parsed again; text beyond.
/// Must hold: the same to the bit; values beyond the limits, a fraction of a count and unknown names are rejected
/// with key and allowed range.
#[test]
fn a_value_as_text_is_parsed_again() {
    let mut kinds = BTreeSet::new();
    for one in listed() {
        kinds.insert(one.kind as u8);
        let off = if one.kind == Kind::Limit { vec![None] } else { vec![] };
        for value in [one.value, one.default, Some(one.min), Some(one.max)].into_iter().chain(off) {
            assert_eq!(one.parse(&one.text(value)), Ok(value), "{}", one.key);
        }
        let wrong = match one.kind {
            Kind::Switch | Kind::Choice => vec!["2".to_owned(), "none".to_owned(), "On".to_owned()],
            Kind::Count => vec![(one.max + 1.0).to_string(), "1.5".into(), "off".into(), "NaN".into()],
            _ => vec![(one.max * 2.0 + 1.0).to_string(), "off".into(), "NaN".into(), String::new()],
        };
        let wrong = wrong.iter().filter(|word| !one.words().contains(&word.as_str()));
        for word in wrong {
            let why = one.parse(word).expect_err(word).to_string();
            assert!(why.starts_with(&one.key) && why.contains(&one.allowed()), "{why}");
        }
    }
    assert_eq!(kinds.len(), 5, "every kind was among them");
}

proptest! {
    /// Situation: any number a parameter can have.
    /// Action: as text, as TOML, and parsed again.
    /// Must hold: the same to the bit.
    #[test]
    fn a_number_survives_a_file(bits in any::<u32>()) {
        let number = f32::from_bits(bits);
        prop_assume!(number.is_finite());
        let one = Parameter {
            key: "any".into(), kind: Kind::Number, value: Some(number), default: None,
            min: f32::MIN, max: f32::MAX, unit: "", names: vec![],
        };
        let written = format!("any = {}", one.toml());
        let table: toml::Table = written.parse().expect("TOML");
        let text = match &table["any"] {
            toml::Value::Integer(number) => number.to_string(),
            toml::Value::Float(number) => number.to_string(),
            other => panic!("{other}"),
        };
        prop_assert_eq!(one.parse(&text).map(|got| got.map(f32::to_bits)), Ok(Some(bits)));
    }
}

/// Situation: every cause, every limit.
/// Action: as text.
/// Must hold: each cause with number, name, a sentence, and an existing page; each limit with a name of its own.
#[test]
fn every_cause_and_limit_has_a_text() {
    let all = named(Causes::all(&CAUSES));
    assert_eq!(all.len(), CAUSES.len());
    for (cause, described) in CAUSES.iter().zip(&all) {
        assert_eq!((described.code, described.name.to_owned()), (cause.code(), format!("{cause:?}")));
        assert!(described.meaning.ends_with('.') && described.meaning.len() > 10, "{described:?}");
        assert!(repository(&described.page).is_file(), "{}", described.page);
    }
    assert_eq!(causes::named(Causes(1 << 63 | 1)), []);
    let names: BTreeSet<_> = (0..10).flat_map(|bit| limits(ActiveLimits(1 << bit))).collect();
    assert_eq!(names.len(), 10);
    assert_eq!(limits(ActiveLimits(0b101)), ["taper", "rate"]);
    assert_eq!(limits(ActiveLimits(!0)).len(), 10);
}

/// Situation: the status of a bus fault by a known address; every bit set; interrupts.
/// Action: as text.
/// Must hold: the manual's description of each defined bit, and no other.
#[test]
fn an_exception_has_a_text() {
    let fault = Exception::new(5, [0x8200, 0x4000_0000, 0xdead_beef, 1, 2, 3]);
    assert_eq!(fault.name, "bus fault");
    let names: Vec<_> = fault.status.iter().filter_map(|text| text.split(':').next()).collect();
    assert_eq!(names, ["PRECISERR", "BFARVALID", "FORCED"]);
    assert_eq!(
        (fault.bfar.as_str(), fault.sp.as_str(), fault.lr.as_str()),
        ("deadbeef", "00000001", "00000003")
    );
    assert_eq!(Exception::new(3, [!0; 6]).status.len(), 19 + 3);
    let name = |number| Exception::new(number, [0; 6]).name;
    assert_eq!(
        [name(3), name(15), name(16 + 37), name(7)],
        ["hard fault", "system tick", "interrupt 37", "reserved"]
    );
}

/// Situation: a fault of every kind.
/// Action: as text.
/// Must hold: kind, start, reset cause and steps; the causes with their pages, the panic's text, the registers.
#[test]
fn a_fault_has_a_text() {
    let texts: Vec<_> = faults().into_iter().map(|record| Fault::from(record).to_string()).collect();
    for (text, named) in texts.iter().zip([
        &["controller in start 5 (software), after 1234 steps at 1.234 s, mode engaged", "1 GyroLost", "docs/faults/01-gyro-lost.md", "57 PolarityWrong"][..],
        &["brown-out in start 4"],
        &["watchdog in start 3 (watchdog)"],
        &["exception 5, bus fault: pc 08001234 lr 08004321 sp 20001000 cfsr 00008200 hfsr 40000000 bfar deadbeef", "PRECISERR"],
        &["panic in start 1", "  panicked at src/tasks/control.rs:12:5:\n  attempt to divide by zero\n"],
        &["drive in start 1", "  gate driver: over-current low a, fault, status 410 001\n"],
    ]) {
        assert!(named.iter().all(|part| text.contains(part)), "{text}");
    }
    assert!(!texts[4].contains("pc "), "{}", texts[4]);
}
