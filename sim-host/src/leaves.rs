//! The flashed code's parameters by name: what each has for a value, and setting one.

use control::Config;
use control::param::{Leaf, Visit};

/// Every parameter but the law's, by name, its value as text that [`set`] takes.
pub fn list(config: &Config) -> Vec<(String, String)> {
    let mut lister = Lister(Vec::new());
    config.clone().leaves(&mut lister);
    lister.0
}

/// The parameters that differ between two configurations, with `config`'s values.
pub fn departing(config: &Config, from: &Config) -> Vec<(String, String)> {
    let both = list(config).into_iter().zip(list(from));
    both.filter(|(a, b)| a != b).map(|(a, _)| a).collect()
}

/// Sets the parameter `key`.
///
/// # Errors
/// No such parameter; a value that is none or out of range.
pub fn set(config: &mut Config, key: &str, value: &str) -> Result<(), String> {
    let mut setter = Setter { key, value, done: None };
    config.leaves(&mut setter);
    setter.done.unwrap_or_else(|| {
        let names: Vec<String> = list(config).into_iter().map(|(name, _)| name).collect();
        Err(format!("no parameter {key}; there are {}", names.join(", ")))
    })
}

fn name(leaf: &Leaf) -> String {
    if leaf.group.is_empty() { leaf.name.into() } else { format!("{}.{}", leaf.group, leaf.name) }
}

/// The names of a switch's values.
const SWITCH: &[&str] = &["off", "on"];

struct Setter<'a> {
    key: &'a str,
    value: &'a str,
    done: Option<Result<(), String>>,
}

impl Setter<'_> {
    /// The value as a number inside the range, if this is the parameter.
    fn number(&mut self, leaf: &Leaf) -> Option<f32> {
        if name(leaf) != self.key {
            return None;
        }
        let parsed = self.value.parse::<f32>().map_err(|_| format!("`{}` is not a number", self.value));
        let checked = parsed.and_then(|x| leaf.check(x).map(|()| x).map_err(|e| e.to_string()));
        self.done = Some(checked.clone().map(drop));
        checked.ok()
    }

    /// The place of the value among `names`, if this is the parameter.
    fn place(&mut self, leaf: &Leaf, names: &[&str]) -> Option<u8> {
        if name(leaf) != self.key {
            return None;
        }
        let place = names.iter().position(|name| *name == self.value);
        let wrong = || format!("`{}` is none of {}", self.value, names.join(", "));
        self.done = Some(place.map(drop).ok_or_else(wrong));
        place.map(|place| place as u8)
    }
}

impl Visit for Setter<'_> {
    fn number(&mut self, leaf: &Leaf, value: &mut f32) {
        if let Some(number) = self.number(leaf) {
            *value = number;
        }
    }
    fn limit(&mut self, leaf: &Leaf, value: &mut Option<f32>) {
        if name(leaf) == self.key && self.value == "none" {
            (*value, self.done) = (None, Some(Ok(())));
        } else if let Some(number) = self.number(leaf) {
            *value = Some(number);
        }
    }
    fn count(&mut self, leaf: &Leaf, value: &mut u16) {
        if let Some(number) = self.number(leaf) {
            if number.fract() == 0.0 {
                *value = number as u16;
            } else {
                self.done = Some(Err(format!("`{}` is not a whole number", self.value)));
            }
        }
    }
    fn switch(&mut self, leaf: &Leaf, value: &mut bool) {
        if let Some(place) = self.place(leaf, SWITCH) {
            *value = place == 1;
        }
    }
    fn choice(&mut self, leaf: &Leaf, names: &'static [&'static str], value: &mut u8) {
        if let Some(place) = self.place(leaf, names) {
            *value = place;
        }
    }
}

struct Lister(Vec<(String, String)>);

impl Visit for Lister {
    fn number(&mut self, leaf: &Leaf, value: &mut f32) {
        self.0.push((name(leaf), value.to_string()));
    }
    fn limit(&mut self, leaf: &Leaf, value: &mut Option<f32>) {
        self.0.push((name(leaf), value.map_or("none".into(), |x| x.to_string())));
    }
    fn count(&mut self, leaf: &Leaf, value: &mut u16) {
        self.0.push((name(leaf), value.to_string()));
    }
    fn switch(&mut self, leaf: &Leaf, value: &mut bool) {
        self.0.push((name(leaf), SWITCH[usize::from(*value)].into()));
    }
    fn choice(&mut self, leaf: &Leaf, names: &'static [&'static str], value: &mut u8) {
        self.0.push((name(leaf), names.get(usize::from(*value)).unwrap_or(&"?").to_string()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use control::Law;
    use proptest::prelude::*;

    /// Situation: a parameter of each kind. Action: set it. Must hold: it has the value; a wrong name, value or
    /// range is refused with what is allowed.
    #[test]
    fn each_kind_is_set() {
        let mut config = Config::thesis(Law::None);
        for (key, value) in [
            ("rate_hz", "500"),
            ("limits.end_stop", "on"),
            ("limits.end_stop.soft_rad", "0.7"),
            ("limits.max_torque_nm", "4"),
            ("input.wheel", "rear"),
            ("input.gyro.timeout_ticks", "7"),
        ] {
            set(&mut config, key, value).unwrap();
            assert!(list(&config).contains(&(key.into(), value.into())), "{key}");
        }
        assert_eq!((config.rate_hz, config.limits.max_torque_nm), (500.0, Some(4.0)));
        assert_eq!(config.limits.end_stop.map(|e| e.soft_rad), Some(0.7));
        assert_eq!((config.input.wheel, config.input.gyro.timeout_ticks), (control::Wheel::Rear, 7));
        set(&mut config, "limits.max_torque_nm", "none").unwrap();
        assert_eq!(config.limits.max_torque_nm, None);
        for (key, value, why) in [
            ("rate", "3", "no parameter rate; there are rate_hz, "),
            ("rate_hz", "x", "not a number"),
            ("rate_hz", "1e9", "outside 100 to 10000"),
            ("input.gyro.timeout_ticks", "1.5", "whole"),
            ("input.wheel", "left", "front, rear"),
            ("limits.end_stop", "2", "off, on"),
        ] {
            let error = set(&mut config, key, value).unwrap_err();
            assert!(error.contains(why), "{error}");
        }
    }

    /// Situation: the flashed configuration. Action: set what departs from the published one, on that. Must
    /// hold: the same but for the law.
    #[test]
    fn a_list_makes_the_configuration_again() {
        let (product, mut config) = (Config::product(), Config::thesis(Law::H { cut: true }));
        let departing = departing(&product, &config);
        assert!((30..200).contains(&departing.len()), "{}", departing.len());
        for (key, value) in &departing {
            set(&mut config, key, value).unwrap();
        }
        assert_eq!(config, product);
    }

    proptest! {
        /// Situation: any texts. Action: set. Must hold: an answer, never a panic.
        #[test]
        fn any_text_is_answered(key in "\\PC*", value in "\\PC*") {
            let mut config = Config::thesis(Law::None);
            prop_assert!(set(&mut config, &key, &value).is_err());
            let _ = set(&mut config, "limits.rise_nm_s", &value);
        }
    }
}
