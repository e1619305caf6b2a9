//! Parameters asked for and set over the link.

use control::param::{Leaf, Visit};
use control::{Config, Law, LawTable};
use link::Key;
use link::bytes::Writer;
use link::law;
use link::leaves::{Kind, each, get};
use link::message::Message;
use link::page::{Entry, PAGE_BYTES};
use link::parameters::{Refusal, Why, answer, set};
use proptest::prelude::*;

/// Asks and hands the answer to `seen`.
fn ask<T>(
    config: &mut Config,
    engaged: bool,
    request: &Message<'_>,
    seen: impl FnOnce(Option<Message<'_>>) -> T,
) -> T {
    seen(answer(&Config::product(), config, engaged, request, &mut [0; PAGE_BYTES]))
}

/// A request that is refused; why, and that nothing changed.
fn refused(config: &Config, engaged: bool, request: &Message<'_>) -> (Why, String) {
    let mut asked = config.clone();
    let refusal = ask(&mut asked, engaged, request, |answer| match answer {
        Some(Message::Refused(refusal)) => (refusal.why, refusal.to_string()),
        other => panic!("{request:?}: {other:?}"),
    });
    assert_eq!(asked, *config, "{request:?}");
    refusal
}

fn to(key: &'static str, value: impl Into<Option<f32>>) -> Message<'static> {
    Message::Set { key: Key::whole(key), value: value.into() }
}

/// An entry of the list, on its own.
#[derive(Clone, Debug, PartialEq)]
struct Listed {
    key: String,
    unit: &'static str,
    kind: Kind,
    numbers: [Option<f32>; 4],
    names: String,
}

fn list(config: &Config) -> (Vec<Listed>, usize) {
    let (mut listed, mut pages) = (Vec::new(), 0);
    loop {
        let from = listed.len() as u16;
        let done = ask(&mut config.clone(), true, &Message::List { from }, |answer| {
            let Some(Message::Page(page)) = answer else { panic!("{answer:?}") };
            assert_eq!((page.from, page.entries().count()), (from, usize::from(page.count)));
            listed.extend(page.entries().map(|entry: Entry<'_>| Listed {
                key: entry.key.to_string(),
                unit: entry.unit(),
                kind: entry.kind,
                numbers: [entry.value, entry.default, Some(entry.min), Some(entry.max)],
                names: entry.names.into(),
            }));
            pages += 1;
            assert!(page.count > 0, "no progress at {from}");
            listed.len() == usize::from(page.total)
        });
        if done {
            return (listed, pages);
        }
    }
}

/// Every leaf of the configuration by its own visitor, as text.
struct Names(Vec<(String, Kind)>);

impl Names {
    fn note(&mut self, leaf: &Leaf, kind: Kind) {
        let dot = if leaf.group.is_empty() { "" } else { "." };
        self.0.push((format!("{}{dot}{}", leaf.group, leaf.name), kind));
    }
}

impl Visit for Names {
    fn number(&mut self, leaf: &Leaf, _: &mut f32) {
        self.note(leaf, Kind::Number);
    }
    fn limit(&mut self, leaf: &Leaf, _: &mut Option<f32>) {
        self.note(leaf, Kind::Limit);
    }
    fn count(&mut self, leaf: &Leaf, _: &mut u16) {
        self.note(leaf, Kind::Count);
    }
    fn switch(&mut self, leaf: &Leaf, _: &mut bool) {
        self.note(leaf, Kind::Switch);
    }
    fn choice(&mut self, leaf: &Leaf, _: &'static [&'static str], _: &mut u8) {
        self.note(leaf, Kind::Choice);
    }
}

/// Situation: a product of which one parameter is not at its default, while engaged.
/// Action: list it page by page.
/// Must hold: the law first, then every leaf in its order under its own name, each with unit, range and default, in 30 to
/// 80 pages.
#[test]
fn every_parameter_is_listed() {
    let mut config = Config::product();
    config.limits.max_torque_nm = Some(3.5);
    let (listed, pages) = list(&config);
    let mut names = Names(vec![("law".into(), Kind::Choice)]);
    config.leaves(&mut names);
    let found: Vec<_> = listed.iter().map(|one| (one.key.clone(), one.kind)).collect();
    assert_eq!(found, names.0);
    assert!((30..=80).contains(&pages), "{pages}");
    let one = |key: &str| listed.iter().find(|one| one.key == key).unwrap_or_else(|| panic!("{key}")).clone();
    let torque = one("limits.max_torque_nm");
    let default = Config::product().limits.max_torque_nm;
    assert_eq!(
        (torque.unit, torque.kind, torque.numbers[0], torque.numbers[1]),
        ("N m", Kind::Limit, Some(3.5), default)
    );
    let law = one("law");
    assert_eq!(
        (law.numbers[0], law.names.as_str()),
        (Some(2.0), "none h h-cut f g cl1 cl2 table balance-assist")
    );
    assert_eq!(one("input.wheel").names, "front rear");
    for (key, unit) in [
        ("rate_hz", "Hz"),
        ("calibration.gyro_bias_x_rad_s", "rad/s"),
        ("permit.self_test_ticks", "control periods"),
        ("permit.lifted_m_s2", "m/s^2"),
        ("limits.window.ms", "ms"),
        ("limits.rise_nm_s", "N m/s"),
        ("input.gyro.slope_per_s", "/s"),
        ("input.gyro.max", ""),
        ("calibration.motor_reversed", ""),
    ] {
        assert_eq!(one(key).unit, unit, "{key}");
    }
}

/// Situation: the list asked for beyond its end.
/// Action: ask.
/// Must hold: an empty page that tells how many there are.
#[test]
fn beyond_the_list_is_an_empty_page() {
    let total = list(&Config::product()).0.len();
    for from in [total as u16, u16::MAX] {
        ask(&mut Config::product(), false, &Message::List { from }, |answer| {
            let Some(Message::Page(page)) = answer else { panic!("{answer:?}") };
            assert_eq!(
                (page.from, usize::from(page.total), page.count, page.bytes),
                (from, total, 0, &[][..])
            );
        });
    }
}

/// Situation: every parameter that is shown.
/// Action: ask for each, set it to what it is, to its ends, and a hair beyond them.
/// Must hold: what was asked; beyond its ends refused as out of range with key, value and range; an end is accepted, or
/// refused with the reason why not; whatever is refused changes nothing.
#[test]
fn every_parameter_is_got_and_set() {
    let mut seen = Vec::new();
    each(&mut Config::product(), |one| {
        seen.push(*one);
        one.value
    });
    let (mut taken, mut not) = (0, 0);
    for one in seen {
        let key = one.key();
        let value = ask(&mut Config::product(), true, &Message::Get { key }, |answer| {
            answer.map(|a| format!("{a:?}"))
        });
        assert_eq!(value, Some(format!("{:?}", Message::Value { key, value: one.value })));
        for end in [one.leaf.min, one.leaf.max] {
            let mut config = Config::product();
            match set(&mut config, key, Some(end)) {
                Ok(()) => {
                    assert_eq!(get(&config, key).and_then(|now| now.value), Some(end), "{key}");
                    assert!(config.plan().is_ok());
                    taken += 1;
                }
                Err(refusal) => {
                    assert_ne!(refusal.to_string(), "");
                    assert_eq!(config, Config::product(), "{key}");
                    not += 1;
                }
            }
        }
        let above = one.leaf.max + one.leaf.max.abs().max(1.0) * 0.01;
        for beyond in [above, one.leaf.min - 1.0, f32::NAN, f32::INFINITY] {
            let mut config = Config::product();
            let refusal = set(&mut config, key, Some(beyond)).expect_err("out of range");
            assert_eq!(
                (refusal.why, refusal.key, refusal.min, refusal.max),
                (Why::OutOfRange, key, one.leaf.min, one.leaf.max)
            );
            assert_eq!(refusal.value.to_bits(), beyond.to_bits());
            assert_eq!(config, Config::product());
        }
    }
    println!("ends: {taken} taken, {not} refused");
    assert!(taken > 250 && not > 20, "{taken} {not}");
}

/// Situation: torque may flow.
/// Action: set, set the law, store, reset; get, list.
/// Must hold: all that changes anything is refused as such, what asks is answered.
#[test]
fn nothing_is_changed_while_engaged() {
    let config = Config::product();
    for request in [
        to("rate_hz", 500.0),
        to("nonsense", 1.0),
        Message::SetLaw(&[0, 0, 0, 0, 0, 0]),
        Message::Store,
        Message::Reset,
    ] {
        assert_eq!(refused(&config, true, &request), (Why::Engaged, "refused while engaged".into()));
    }
    for request in [Message::List { from: 0 }, Message::Get { key: Key::whole("law") }, Message::GetLaw] {
        ask(&mut config.clone(), true, &request, |answer| {
            assert!(!matches!(answer, Some(Message::Refused(_)) | None))
        });
    }
}

/// Situation: requests with every kind of mistake.
/// Action: send each.
/// Must hold: refused with the reason in words that name key, value and range; nothing changed.
#[test]
fn a_mistake_is_told() {
    let config = Config::product();
    let mut untapered = config.clone();
    untapered.limits.taper = None;
    for (config, request, why, words) in [
        (&config, to("limits.max_torque", 1.0), Why::UnknownKey, "no parameter limits.max_torque"),
        (&config, Message::Get { key: Key::whole("") }, Why::UnknownKey, "no parameter "),
        (&config, to("law.cl2.k", 1.0), Why::UnknownKey, "no parameter law.cl2.k"),
        (&config, to("rate_hz", 99.0), Why::OutOfRange, "rate_hz = 99 is outside 100 to 10000"),
        (&config, to("rate_hz", None), Why::NeverOff, "rate_hz can't be off, only 100 to 10000"),
        (
            &config,
            to("permit.ramp_in_ticks", 0.5),
            Why::NotWhole,
            "permit.ramp_in_ticks = 0.5 is not a whole number of 0 to 20000",
        ),
        (
            &config,
            to("calibration.motor_reversed", 0.5),
            Why::NotWhole,
            "calibration.motor_reversed = 0.5 is not a whole number of 0 to 1",
        ),
        (&config, to("law", 9.0), Why::OutOfRange, "law = 9 is outside 0 to 8"),
        (&config, to("law", 6.0), Why::OutOfRange, "law.cl2.k = 0 is outside 0.001 to 20"),
        (&config, to("law", 7.0), Why::OutOfRange, "law.table.points = 0 is outside 1 to 32"),
        (
            &config,
            to("calibration.polarity_checked", 1.0),
            Why::OnlyByCheck,
            "calibration.polarity_checked is set by the polarity check alone",
        ),
        (
            &untapered,
            to("limits.taper.full_m_s", 2.0),
            Why::GroupOff,
            "limits.taper.full_m_s is in a group that is off; switch that on first",
        ),
        (&config, Message::SetLaw(&[0, 0]), Why::Malformed, "the request can't be read"),
        (&config, Message::SetLaw(&[200, 0, 0, 0, 0, 0]), Why::OutOfRange, "law = 200 is outside 0 to 8"),
        (
            &config,
            Message::SetLaw(&[6, 0, 0, 0, 0, 0]),
            Why::OutOfRange,
            "law.cl2.k = 0 is outside 0.001 to 20",
        ),
    ] {
        assert_eq!(refused(config, false, &request), (why, words.into()), "{request:?}");
    }
}

/// Situation: two parameters that must fit each other, each set within its own range.
/// Action: set the one to where the other forbids it.
/// Must hold: refused by the check of the whole; nothing changed.
#[test]
fn the_configuration_is_checked_as_a_whole() {
    let config = Config::product();
    let taper = config.limits.taper.expect("a taper");
    let request = to("limits.taper.full_m_s", taper.zero_m_s / 2.0);
    let (why, words) = refused(&config, false, &request);
    assert_eq!(why, Why::OutOfRange);
    assert!(words.contains("limits.taper"), "{words}");
}

/// Situation: a bicycle whose polarity check was passed.
/// Action: set something of the calibration; something else; the check's own mark to off.
/// Must hold: the calibration's change takes the mark away, the other does not; off is allowed, on is not.
#[test]
fn a_changed_calibration_is_an_unchecked_one() {
    let mut checked = Config::product();
    checked.calibration.polarity_checked = true;
    for (key, value, stays) in [
        ("calibration.motor_reversed", 1.0, false),
        ("calibration.steer_zero_rad", 0.1, false),
        ("calibration.polarity_checked", 0.0, false),
        ("calibration.steer_zero_rad", 0.0, true),
        ("calibration.polarity_checked", 1.0, true),
        ("permit.ramp_in_ticks", 300.0, true),
    ] {
        let mut config = checked.clone();
        set(&mut config, Key::whole(key), Some(value)).expect("allowed");
        assert_eq!(config.calibration.polarity_checked, stays, "{key}");
        assert_eq!(get(&config, Key::whole(key)).and_then(|seen| seen.value), Some(value));
    }
    ask(&mut checked, false, &Message::Reset, |answer| assert_eq!(answer, Some(Message::Done)));
    assert_eq!(checked, Config::product());
}

/// Situation: laws of every kind.
/// Action: set each as a whole, and ask for it; list the parameters then.
/// Must hold: the same law; its own slope is among the parameters, and can be set there.
#[test]
fn a_law_is_set_as_a_whole() {
    let table = LawTable::new(&[(-1.0, 0.0), (2.0, 12.0), (8.0, 0.0)]).expect("a table");
    let full: Vec<_> = (0..32_u8).map(|i| (0.2 * f32::from(i), 1.0)).collect();
    for (law, slope) in [
        (Law::None, None),
        (Law::H { cut: false }, None),
        (Law::Cl2 { k: 2.0 }, Some("law.cl2.k")),
        (Law::BalanceAssist { kappa: 3.9 }, Some("law.balance-assist.kappa")),
        (Law::Table(table), None),
        (Law::Table(LawTable::new(&full).expect("a table")), None),
    ] {
        let mut bytes = [0; law::LAW_BYTES];
        let mut writer = Writer::new(&mut bytes);
        law::encode(&law, &mut writer);
        let bytes = writer.finish().expect("room");
        let mut config = Config::product();
        ask(&mut config, false, &Message::SetLaw(bytes), |answer| {
            assert_eq!(answer, Some(Message::Law(bytes)))
        });
        assert_eq!(config.law, law);
        ask(&mut config, true, &Message::GetLaw, |answer| assert_eq!(answer, Some(Message::Law(bytes))));
        let listed = list(&config).0;
        let own: Vec<_> =
            listed.iter().map(|one| one.key.as_str()).filter(|key| key.starts_with("law.")).collect();
        assert_eq!(own, slope.into_iter().collect::<Vec<_>>());
        if let Some(key) = slope {
            set(&mut config, Key::whole(key), Some(1.5)).expect("allowed");
            assert_eq!(config.law.slope(), 1.5);
        }
    }
}

/// Situation: requests that the caller has to answer, and what is no request.
/// Action: ask.
/// Must hold: no answer from here, nothing changed.
#[test]
fn what_others_answer_is_left_to_them() {
    for request in [
        Message::AskHello,
        Message::Store,
        Message::PilReset,
        Message::Done,
        Message::WrongVersion { theirs: 2 },
    ] {
        let mut config = Config::product();
        ask(&mut config, false, &request, |answer| assert_eq!(answer, None));
        assert_eq!(config, Config::product());
    }
}

proptest! {
    /// Situation: any sequence of sets of any parameter to anything.
    /// Action: carry them out one after the other.
    /// Must hold: after each the configuration is one that `plan` accepts, and unchanged if it was refused.
    #[test]
    fn no_set_leaves_a_configuration_that_is_refused(
        sets in prop::collection::vec((any::<prop::sample::Index>(), any::<u32>(), 0.0_f32..1.0, 0..4_u8), 1..12)
    ) {
        let mut config = Config::product();
        for (which, bits, share, how) in sets {
            let mut seen = Vec::new();
            each(&mut config.clone(), |one| {
                seen.push(*one);
                one.value
            });
            let one = seen[which.index(seen.len())];
            let inside = one.leaf.min + share * (one.leaf.max - one.leaf.min);
            let value = [None, Some(f32::from_bits(bits)), Some(inside), Some(inside.round())][usize::from(how)];
            let before = config.clone();
            let done = set(&mut config, one.key(), value).map_err(|Refusal { why, .. }| why);
            prop_assert!(config.clone().plan().is_ok(), "{} {:?}", one.key(), value);
            prop_assert!(done.is_ok() || config == before, "{} {:?}", one.key(), value);
        }
    }
}
