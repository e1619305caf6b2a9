//! Lists and sets the controller's parameters by name.

use crate::range::plain;
use control::Config;
use control::param::{ParamError, ParamSpec, ParamVisitor};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

/// A parameter's value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "a number, a word, true or false")]
pub enum Value {
    /// A switch.
    Switch(bool),
    /// A number, in the parameter's unit.
    Number(f64),
    /// The word of a choice, on or off, or none.
    Word(String),
}

impl From<&str> for Value {
    /// A number if the text is one, otherwise a word.
    fn from(text: &str) -> Self {
        text.parse().map_or_else(|_| Self::Word(text.into()), Self::Number)
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Switch(on) => f.write_str(SWITCH[usize::from(*on)]),
            Self::Number(number) => f.write_str(&plain(*number)),
            Self::Word(word) => f.write_str(word),
        }
    }
}

/// Name and value of every parameter except the law's, in the text form that [`set`] reads.
pub fn list(config: &Config) -> Vec<(String, String)> {
    let mut lister = Lister(Vec::new());
    config.clone().visit_params(&mut lister);
    lister.0
}

/// The parameters in which `config` differs from `from`, with `config`'s values.
pub fn departing(config: &Config, from: &Config) -> Vec<(String, String)> {
    let both = list(config).into_iter().zip(list(from));
    both.filter(|(a, b)| a != b).map(|(a, _)| a).collect()
}

/// A parameter that can't be set.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SetError {
    /// No parameter has this name.
    #[error("no parameter {key}; nearest are {}; `sim-host param list --defaults` shows all", near.join(", "))]
    Unknown {
        /// As given.
        key: String,
        /// The three most similar names.
        near: Vec<String>,
    },
    /// Not a number.
    #[error("`{0}` is not a number")]
    Number(String),
    /// Not a whole number.
    #[error("`{0}` is not a whole number")]
    Whole(String),
    /// A number outside its range.
    #[error("{0}")]
    Range(ParamError),
    /// None of the names that it can have.
    #[error("`{value}` is none of {known}")]
    Choice {
        /// As given.
        value: String,
        /// The names.
        known: String,
    },
}

impl From<ParamError> for SetError {
    fn from(error: ParamError) -> Self {
        Self::Range(error)
    }
}

/// A parameter that can't be set to a value.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{key}={value}: {error}")]
pub struct Rejected {
    /// Its name.
    pub key: String,
    /// The value.
    pub value: Value,
    /// The reason.
    pub error: SetError,
}

/// Sets the parameter `key` to a value in text form.
///
/// # Errors
/// An unknown parameter; a value of another kind or out of range.
pub fn set(config: &mut Config, key: &str, value: &str) -> Result<(), SetError> {
    set_value(config, key, &value.into())
}

/// Sets the parameter `key`.
///
/// # Errors
/// As [`set`].
pub fn set_value(config: &mut Config, key: &str, value: &Value) -> Result<(), SetError> {
    let mut setter = Setter { key, value, done: None };
    config.visit_params(&mut setter);
    setter.done.unwrap_or_else(|| {
        let near = nearest(list(config).into_iter().map(|(name, _)| name), key);
        Err(SetError::Unknown { key: key.into(), near })
    })
}

/// The three names most similar to `word` (Jaro-Winkler).
fn nearest(names: impl Iterator<Item = String>, word: &str) -> Vec<String> {
    let mut near: Vec<_> = names.map(|name| (strsim::jaro_winkler(&name, word), name)).collect();
    near.sort_by(|a, b| b.0.total_cmp(&a.0));
    near.into_iter().take(3).map(|(_, name)| name).collect()
}

fn name(leaf: &ParamSpec) -> String {
    if leaf.group.is_empty() { leaf.name.into() } else { format!("{}.{}", leaf.group, leaf.name) }
}

/// Names of a switch's values.
const SWITCH: &[&str] = &["off", "on"];

struct Setter<'a> {
    key: &'a str,
    value: &'a Value,
    done: Option<Result<(), SetError>>,
}

impl Setter<'_> {
    /// The value as a number inside the range, if `leaf` is the parameter to set.
    fn number(&mut self, leaf: &ParamSpec) -> Option<f32> {
        if name(leaf) != self.key {
            return None;
        }
        let parsed = match self.value {
            Value::Number(x) if !(*x as f32).is_infinite() => Ok(*x as f32),
            other => Err(SetError::Number(other.to_string())),
        };
        let checked = parsed.and_then(|x| leaf.check(x).map(|()| x).map_err(SetError::from));
        self.done = Some(checked.clone().map(drop));
        checked.ok()
    }

    /// Index of the value in `names`, if `leaf` is the parameter to set.
    fn place(&mut self, leaf: &ParamSpec, names: &[&str]) -> Option<u8> {
        if name(leaf) != self.key {
            return None;
        }
        let word = self.value.to_string();
        let place = names.iter().position(|name| *name == word);
        let wrong = || SetError::Choice { value: word.clone(), known: names.join(", ") };
        self.done = Some(place.map(drop).ok_or_else(wrong));
        place.map(|place| place as u8)
    }
}

impl ParamVisitor for Setter<'_> {
    fn number(&mut self, leaf: &ParamSpec, value: &mut f32) {
        if let Some(number) = self.number(leaf) {
            *value = number;
        }
    }
    fn optional_number(&mut self, leaf: &ParamSpec, value: &mut Option<f32>) {
        if name(leaf) == self.key && matches!(self.value, Value::Word(word) if word == "none") {
            (*value, self.done) = (None, Some(Ok(())));
        } else if let Some(number) = self.number(leaf) {
            *value = Some(number);
        }
    }
    fn count(&mut self, leaf: &ParamSpec, value: &mut u16) {
        if let Some(number) = self.number(leaf) {
            if number.fract() == 0.0 {
                *value = number as u16;
            } else {
                self.done = Some(Err(SetError::Whole(self.value.to_string())));
            }
        }
    }
    fn switch(&mut self, leaf: &ParamSpec, value: &mut bool) {
        if let Some(place) = self.place(leaf, SWITCH) {
            *value = place == 1;
        }
    }
    fn choice(&mut self, leaf: &ParamSpec, names: &'static [&'static str], value: &mut u8) {
        if let Some(place) = self.place(leaf, names) {
            *value = place;
        }
    }
}

struct Lister(Vec<(String, String)>);

impl ParamVisitor for Lister {
    fn number(&mut self, leaf: &ParamSpec, value: &mut f32) {
        self.0.push((name(leaf), value.to_string()));
    }
    fn optional_number(&mut self, leaf: &ParamSpec, value: &mut Option<f32>) {
        self.0.push((name(leaf), value.map_or("none".into(), |x| x.to_string())));
    }
    fn count(&mut self, leaf: &ParamSpec, value: &mut u16) {
        self.0.push((name(leaf), value.to_string()));
    }
    fn switch(&mut self, leaf: &ParamSpec, value: &mut bool) {
        self.0.push((name(leaf), SWITCH[usize::from(*value)].into()));
    }
    fn choice(&mut self, leaf: &ParamSpec, names: &'static [&'static str], value: &mut u8) {
        self.0.push((name(leaf), names.get(usize::from(*value)).unwrap_or(&"?").to_string()));
    }
}
