//! The laws beyond those of the thesis, and the gain at an uncertain speed.

use control::law::{LAWS, LawError};
use control::param::{Checker, ParamVisitor};
use control::{Capsize, GainSchedule, Law};
use proptest::prelude::*;
use proptest::sample::select;
use sim_host::bicycle::catalogue;
use sim_host::eigen::{Feedback, Model, critical_speeds, rightmost, stability};

fn any_law() -> impl Strategy<Value = Law> {
    let table = prop::collection::vec((0.05_f32..3.0, -60.0_f32..60.0), 1..=32).prop_map(|points| {
        let mut speed = -12.0;
        let risen = points.into_iter().map_while(|(gap, gain)| {
            speed += gap;
            (speed < 30.0).then_some((speed, gain))
        });
        let points: Vec<(f32, f32)> = risen.collect();
        GainSchedule::new(&points).expect("a valid table")
    });
    (select(&LAWS), 0.001_f32..20.0, table).prop_map(|(spec, slope, table)| (spec.build)(slope, table))
}

/// Effect of rounding on a gain: the terms of f are up to this large.
fn rounding(v: f32, gain: f32) -> f32 {
    4e-7 * (0.88 * v * v + 12.0 * v.abs() + 41.0 + gain.abs())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    /// Situation: a speed interval, any law.
    /// Action: compute the gain towards zero; evaluate a thousand speeds in the interval.
    /// Must hold: no gain in the interval is smaller or of the other sign; and it is the least of them, not less; the
    /// order of the two does not matter; one speed twice gives the gain itself, to the bit.
    #[test]
    fn a_wrong_speed_never_raises_the_gain(law in any_law(), a in -12.0_f32..14.0, width in 0.0_f32..9.0) {
        let b = a + width;
        let safe = law.gain_towards_zero(a, b);
        prop_assert_eq!(safe.to_bits(), law.gain_towards_zero(b, a).to_bits());
        prop_assert_eq!(law.gain_towards_zero(a, a).to_bits(), law.gain(a).to_bits());
        let speeds = (0_u16..=1000).map(|i| a + (b - a) * (f32::from(i) / 1000.0));
        let gains: Vec<(f32, f32)> = speeds.map(|v| (v, law.gain(v))).collect();
        let (mut least, mut largest_step) = (f32::INFINITY, 0.0_f32);
        let (mut below, mut above) = (false, false);
        for (i, (v, gain)) in gains.iter().enumerate() {
            prop_assert!(safe.abs() <= gain.abs() + rounding(*v, *gain), "{safe} but {gain} at {v}");
            prop_assert!(safe * gain >= 0.0, "{safe} but {gain} at {v}");
            least = least.min(gain.abs());
            largest_step = largest_step.max(i.checked_sub(1).map_or(0.0, |j| (gain - gains[j].1).abs()));
            (below, above) = (below || *gain < 0.0, above || *gain > 0.0);
        }
        let reached = if below && above { 0.0 } else { least };
        prop_assert!(safe.abs() >= reached - 2.0 * largest_step - rounding(b, safe), "{safe}, {reached}");
    }
}

/// Situation: f, whose gain is least at 6.8 m/s; a table with a dip; h, which changes sign at 7.5 m/s.
/// Action: evaluate between speeds on both sides.
/// Must hold: the gains inside the interval count, not only those at its ends.
#[test]
fn the_gains_inside_the_interval_count() {
    assert!((Law::F.gain_towards_zero(6.0, 7.5) - 0.0909).abs() < 1e-4);
    assert!(Law::F.gain(6.0_f32) > 0.6 && Law::F.gain(7.5_f32) > 0.4);
    let dip = Law::Table(GainSchedule::new(&[(0.0, 9.0), (3.0, 2.0), (5.0, 8.0)]).expect("valid"));
    assert_eq!(dip.gain_towards_zero(1.0, 5.0), 2.0);
    let through = Law::Table(GainSchedule::new(&[(0.0, 9.0), (3.0, -2.0), (5.0, 8.0)]).expect("valid"));
    assert_eq!(through.gain_towards_zero(0.0, 5.0), 0.0);
    assert_eq!(Law::H { cut: false }.gain_towards_zero(7.0, 8.0), 0.0);
    assert_eq!(Law::BalanceAssist { kappa: 3.9 }.gain_towards_zero(0.0, 4.0), 0.0);
}

/// Situation: the balance assist as published: 0 at rest, 3.2 kappa at 1.5 m/s, 0 from 4.7 m/s.
/// Action: evaluate in both number types.
/// Must hold: those values, straight lines between, zero when rolling backwards.
#[test]
fn the_balance_assist_is_as_published() {
    for kappa in [3.9_f32, 5.2] {
        let law = Law::BalanceAssist { kappa };
        let k = f64::from(kappa);
        for (v, gain) in [
            (-3.0, 0.0),
            (0.0, 0.0),
            (0.75, 1.6 * k),
            (1.5, 3.2 * k),
            (3.0, 1.7 * k),
            (4.6, 0.1 * k),
            (4.7, 0.0),
            (9.0, 0.0),
        ] {
            assert!((law.gain(v) - gain).abs() < 1e-12, "{v}");
            assert!((f64::from(law.gain(v as f32)) - gain).abs() < 2e-6, "{v}");
        }
        // Without a jump.
        assert!((law.gain(1.5_f32) - law.gain(1.5_f32.next_down())).abs() < 1e-5);
    }
    let out_of_range = Law::BalanceAssist { kappa: 20.5 }.validate().expect_err("too steep");
    assert_eq!(out_of_range.to_string(), "law.balance-assist.kappa = 20.5 is outside 0.001 to 20");
}

/// Situation: every shipped bicycle that has a capsize speed, hands off.
/// Action: add the capsize term, then the same with the other sign.
/// Must hold: a lean to the right gives a torque to the right; with the gain of the steer-by-wire bicycle and enough
/// of it capsize is stable up to 20 m/s, and with the other sign the fall is faster than without assist.
#[test]
fn the_capsize_term_steers_into_the_lean() {
    let mut bicycles = 0;
    for name in catalogue::shipped_names() {
        let parameters = catalogue::load(&name).expect("ships").parameters;
        let model = |capsize| Model::new(&parameters, Feedback::WithCapsize(Law::None, capsize), None);
        let alone = Model::new(&parameters, Feedback::Law(Law::None), None);
        let Some(v_c) = critical_speeds(alone.linear(), &Law::None).v_c else { continue };
        let capsize = Capsize { k_c: 0.7, v_max_m_s: 0.95 * v_c as f32 };
        assert!(capsize.torque(2.0 * v_c as f32, 0.1) > 0.0 && capsize.torque(2.0 * v_c as f32, -0.1) < 0.0);
        let opposite = Capsize { k_c: -0.7, ..capsize };
        let growth = |model: &Model, v: f64| rightmost(&model.at(v)).re;
        for v in [1.1 * v_c, 1.5 * v_c, 2.0 * v_c] {
            let (with, without, against) =
                (growth(&model(capsize), v), growth(&alone, v), growth(&model(opposite), v));
            assert!(
                without > 0.0 && with < 0.0 && against > without,
                "{name} {v}: {with} {without} {against}"
            );
        }
        let found = stability(&model(capsize)).expect("roots");
        assert_eq!(found.critical.v_c, None, "{name}: {:?}", found.changes);
        bicycles += 1;
    }
    assert!(bicycles > 15, "{bicycles}");
}

/// Situation: the capsize term off, below its speed, and out of range.
/// Action: compute its torque; check it.
/// Must hold: zero; the parameter, value and range are named.
#[test]
fn the_capsize_term_is_off_by_default() {
    assert!(!Capsize::default().is_on());
    assert_eq!(Capsize::default().torque(20.0, 0.5), 0.0);
    let on = Capsize { k_c: 0.7, v_max_m_s: 6.5 };
    assert_eq!([on.torque(6.5, 0.5), on.torque(-9.0, 0.5)], [0.0, 0.0]);
    assert_eq!(on.torque(8.5, 0.5), 0.7);
    let rejected = Capsize { k_c: 21.0, ..on }.validate().expect_err("too large");
    assert_eq!(rejected.to_string(), "capsize.k_c = 21 is outside 0 to 20");
    assert!(Capsize { v_max_m_s: f32::NAN, ..on }.validate().is_err());
}

/// Records a law's values, or sets them in another.
#[derive(Default)]
struct Tape {
    values: std::collections::VecDeque<f32>,
    plays: bool,
}

impl Tape {
    fn pass(&mut self, value: f32) -> f32 {
        if self.plays {
            return self.values.pop_front().expect("as many as were written");
        }
        self.values.push_back(value);
        value
    }
}

impl ParamVisitor for Tape {
    fn number(&mut self, _: &control::param::ParamSpec, value: &mut f32) {
        *value = self.pass(*value);
    }
    fn optional_number(&mut self, _: &control::param::ParamSpec, _: &mut Option<f32>) {
        unreachable!("a law has no limits");
    }
    fn count(&mut self, _: &control::param::ParamSpec, value: &mut u16) {
        *value = self.pass(f32::from(*value)) as u16;
    }
    fn switch(&mut self, _: &control::param::ParamSpec, _: &mut bool) {
        unreachable!("a law has no switches");
    }
    fn choice(&mut self, _: &control::param::ParamSpec, names: &'static [&'static str], value: &mut u8) {
        *value = self.pass(f32::from(*value)) as u8;
        assert!(usize::from(*value) < names.len());
    }
}

proptest! {
    /// Situation: any law, and another one.
    /// Action: visit the parameters of the first with a visitor that records them, and of the other with one that sets them.
    /// Must hold: the first is unchanged, the other becomes the first; of a table only the kind, since a table keeps its
    /// points. The range check accepts a law, as `validate` does.
    #[test]
    fn the_parameters_define_a_law_except_the_points_of_a_table(law in any_law(), other in any_law()) {
        let (mut from, mut to, mut tape) = (law.clone(), other.clone(), Tape::default());
        from.visit_params(&mut tape);
        prop_assert_eq!(&from, &law);
        tape.plays = true;
        to.visit_params(&mut tape);
        prop_assert!(tape.values.is_empty());
        match (&law, &other) {
            (Law::Table(_), Law::Table(_)) => prop_assert_eq!(&to, &other),
            (Law::Table(_), _) => prop_assert_eq!(&to, &Law::Table(GainSchedule::default())),
            _ => prop_assert_eq!(&to, &law),
        }
        let mut checker = Checker::default();
        from.visit_params(&mut checker);
        prop_assert_eq!(checker.verdict(), Ok(()));
        prop_assert_eq!(from.validate(), Ok(()));
    }
}

/// Situation: every declared law, its parameter 1.5 where it has one.
/// Action: get its number, write it as text and parse it.
/// Must hold: the number is its place in the declarations and the text gives the same law; a table, which needs
/// points, is no law by its name.
#[test]
fn every_declared_law_is_read_by_its_name() {
    for (number, spec) in LAWS.iter().enumerate() {
        let table = GainSchedule::new(&[(0.0, 1.0)]).expect("a table");
        let law = (spec.build)(1.5, table);
        assert_eq!(usize::from(law.number()), number, "{}", spec.name);
        assert_eq!(LAWS.iter().filter(|other| other.name == spec.name).count(), 1, "{}", spec.name);
        let text = law.to_string();
        let written = if spec.parameter.is_some() { format!("{}:1.5", spec.name) } else { spec.name.into() };
        assert_eq!(text, written);
        let is_table = matches!(law, Law::Table(_));
        assert_eq!(text.parse(), if is_table { Err(LawError::Unknown) } else { Ok(law) }, "{text}");
    }
}

/// Situation: texts that are not a law.
/// Action: parse them.
/// Must hold: the error is the applicable one.
#[test]
fn an_invalid_law_has_its_reason() {
    let read = |text: &str| text.parse::<Law>().expect_err(text);
    for text in ["", "H", "h ", "table", "table:1", "cl3:2"] {
        assert_eq!(read(text), LawError::Unknown, "`{text}`");
    }
    assert_eq!(read("h:2"), LawError::NoParameter);
    for text in ["cl2", "cl2:", "cl2:x", "cl2:1:2"] {
        assert!(matches!(read(text), LawError::NotANumber(spec) if spec.name == "cl2.k"), "{text}");
    }
    for text in ["cl2:0", "cl2:-1", "cl2:nan", "cl2:20.5", "balance-assist:inf"] {
        assert!(matches!(read(text), LawError::OutOfRange(_)), "{text}");
    }
}
