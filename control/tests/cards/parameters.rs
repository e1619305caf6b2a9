//! Every field of the configuration is a parameter.

use control::Config;
use control::param::{ParamSpec, ParamVisitor};
use std::collections::BTreeMap;

/// Sets every parameter: numbers, counts and choices to the lower or the upper end of their range, switches on, all but
/// one.
struct Set {
    upper: bool,
    off: Option<usize>,
    switches: usize,
}

impl Set {
    fn end(&self, spec: &ParamSpec) -> f32 {
        if self.upper { spec.max } else { spec.min }
    }
}

impl ParamVisitor for Set {
    fn number(&mut self, spec: &ParamSpec, value: &mut f32) {
        *value = self.end(spec);
    }
    fn optional_number(&mut self, spec: &ParamSpec, value: &mut Option<f32>) {
        *value = Some(self.end(spec));
    }
    fn count(&mut self, spec: &ParamSpec, value: &mut u16) {
        *value = self.end(spec) as u16;
    }
    fn switch(&mut self, _: &ParamSpec, value: &mut bool) {
        *value = self.off != Some(self.switches);
        self.switches += 1;
    }
    fn choice(&mut self, spec: &ParamSpec, _: &'static [&'static str], value: &mut u8) {
        *value = self.end(spec) as u8;
    }
}

/// The product's configuration with all parameters set, and the number of switches.
fn with(upper: bool, off: Option<usize>) -> (BTreeMap<String, String>, usize) {
    let (mut config, mut set) = (Config::product(), Set { upper, off, switches: 0 });
    config.visit_params(&mut set);
    (fields(&format!("{config:#?}")), set.switches)
}

/// Value of each field in a text of `{:#?}`, by its path.
fn fields(text: &str) -> BTreeMap<String, String> {
    let (mut path, mut fields) = (Vec::new(), BTreeMap::new());
    for line in text.lines().map(str::trim) {
        let (name, value) = line.split_once(": ").unwrap_or(("", line));
        match value.trim_end_matches(',') {
            ")" | "}" | "]" => drop(path.pop()),
            opens if opens.ends_with(['(', '{', '[']) => path.push(name.to_owned()),
            leaf => {
                let place = format!("{}.{name}", path.join("."));
                // Elements of an array have no name.
                let place = if name.is_empty() { format!("{place}{}", fields.len()) } else { place };
                fields.insert(place, leaf.to_owned());
            }
        }
    }
    fields
}

/// Situation: the configuration with every parameter at the lower end of its range and every switch on.
/// Action: set every number to the upper end; turn each switch off, one after the other.
/// Must hold: every field of the configuration except the law changes by one of these, so none is missing in
/// `visit_params`; more than 150 fields are compared.
#[test]
fn every_field_is_a_parameter() {
    let ((lower, switches), (upper, _)) = (with(false, None), with(true, None));
    let turned_off: Vec<_> = (0..switches).map(|off| with(false, Some(off)).0).collect();
    let fixed: Vec<&String> = lower
        .iter()
        .filter(|(place, value)| upper.get(*place) == Some(*value))
        .filter(|(place, _)| {
            !turned_off.iter().any(|fields| fields.get(*place).is_some_and(|value| value == "false"))
        })
        .map(|(place, _)| place)
        .filter(|place| !place.starts_with(".law") && !place.starts_with(".Law"))
        .collect();
    assert!((150..500).contains(&lower.len()), "{}", lower.len());
    assert_eq!(fixed, Vec::<&String>::new(), "missing in visit_params, or fixed by their range");
}
