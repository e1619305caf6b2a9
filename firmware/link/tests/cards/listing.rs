//! The parameter list, including the law.

use crate::requests::answer_to;
use control::law::LAW_NAMES;
use control::param::{ParamSpec, ParamVisitor};
use control::{Config, GainSchedule, Law};
use link::Key;
use link::bytes::Writer;
use link::law;
use link::message::Message;
use link::page::Entry;
use link::parameter_list::Kind;
use link::requests::set;

/// An owned entry of the list.
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
        let done = answer_to(&mut config.clone(), true, &Message::List { from }, |answer| {
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

/// Every parameter of the configuration by its own visitor, as text.
struct Names(Vec<(String, Kind)>);

impl Names {
    fn note(&mut self, leaf: &ParamSpec, kind: Kind) {
        let dot = if leaf.group.is_empty() { "" } else { "." };
        self.0.push((format!("{}{dot}{}", leaf.group, leaf.name), kind));
    }
}

impl ParamVisitor for Names {
    fn number(&mut self, leaf: &ParamSpec, _: &mut f32) {
        self.note(leaf, Kind::Number);
    }
    fn optional_number(&mut self, leaf: &ParamSpec, _: &mut Option<f32>) {
        self.note(leaf, Kind::Limit);
    }
    fn count(&mut self, leaf: &ParamSpec, _: &mut u16) {
        self.note(leaf, Kind::Count);
    }
    fn switch(&mut self, leaf: &ParamSpec, _: &mut bool) {
        self.note(leaf, Kind::Switch);
    }
    fn choice(&mut self, leaf: &ParamSpec, _: &'static [&'static str], _: &mut u8) {
        self.note(leaf, Kind::Choice);
    }
}

/// Situation: a product with one parameter off its default, while engaged.
/// Action: list it page by page.
/// Must hold: the law first, then every parameter in order under its own name, each with unit, range and default, in
/// 30 to 80 pages.
#[test]
fn every_parameter_is_listed() {
    let mut config = Config::product();
    config.limits.max_torque_nm = Some(3.5);
    let (listed, pages) = list(&config);
    let mut names = Names(vec![("law".into(), Kind::Choice)]);
    config.visit_params(&mut names);
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
        (Some(f32::from(config.law.number())), LAW_NAMES.join(" ").as_str())
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

/// Situation: a request for the list beyond its end.
/// Action: send it.
/// Must hold: an empty page with the number of parameters.
#[test]
fn beyond_the_list_is_an_empty_page() {
    let total = list(&Config::product()).0.len();
    for from in [total as u16, u16::MAX] {
        answer_to(&mut Config::product(), false, &Message::List { from }, |answer| {
            let Some(Message::Page(page)) = answer else { panic!("{answer:?}") };
            assert_eq!(
                (page.from, usize::from(page.total), page.count, page.bytes),
                (from, total, 0, &[][..])
            );
        });
    }
}

/// Situation: laws of every kind.
/// Action: set each as a whole, and read it; then list the parameters.
/// Must hold: the same law; its slope is among the parameters, and can be set there.
#[test]
fn a_law_is_set_as_a_whole() {
    let table = GainSchedule::new(&[(-1.0, 0.0), (2.0, 12.0), (8.0, 0.0)]).expect("a table");
    let full: Vec<_> = (0..32_u8).map(|i| (0.2 * f32::from(i), 1.0)).collect();
    for (law, slope) in [
        (Law::None, None),
        (Law::H { cut: false }, None),
        (Law::Cl2 { k: 2.0 }, Some("law.cl2.k")),
        (Law::BalanceAssist { kappa: 3.9 }, Some("law.balance-assist.kappa")),
        (Law::Table(table), None),
        (Law::Table(GainSchedule::new(&full).expect("a table")), None),
    ] {
        let mut bytes = [0; law::LAW_BYTES];
        let mut writer = Writer::new(&mut bytes);
        law::encode(&law, &mut writer);
        let bytes = writer.finish().expect("room");
        let mut config = Config::product();
        answer_to(&mut config, false, &Message::SetLaw(bytes), |answer| {
            assert_eq!(answer, Some(Message::Law(bytes)))
        });
        assert_eq!(config.law, law);
        answer_to(&mut config, true, &Message::GetLaw, |answer| {
            assert_eq!(answer, Some(Message::Law(bytes)))
        });
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
