//! The settings of a scenario by name, as text: options of the command line and axes of a sweep read this table.

mod conditions;
mod given;
mod rider;
mod start;

pub use conditions::{BICYCLES, CONDITIONS, FALL};
pub use given::{Given, GivenError};
pub use rider::RIDERS;
pub(super) use start::DRAWS;
pub use start::{ADAPTIVE, PLANE, SEARCH, START, UNCERTAIN};

use super::{Scenario, TextError, unit_of};

/// A setting: how it is named and described, and how its text changes a scenario.
#[derive(Debug)]
pub struct Setting {
    /// Name: `--name` on the command line, key of an axis.
    pub name: &'static str,
    /// Key in a scenario's file, with dots; that of a number with a unit ends with the unit.
    pub key: &'static str,
    /// What it is, in a few words, if the name is not enough.
    pub long_name: &'static str,
    /// Placeholder of the value in help texts.
    pub value: &'static str,
    /// Description.
    pub help: &'static str,
    /// Default as text; `None` if it depends on other settings.
    pub default: Option<&'static str>,
    /// Value of the option given without one; `None` if it needs one.
    pub alone: Option<&'static str>,
    /// The allowed words and their meaning; empty if the value is not a word of a list.
    pub words: &'static [(&'static str, &'static str)],
    /// Whether it must be given where it is an option.
    pub required: bool,
    /// Whether it may be given several times.
    pub repeats: bool,
    /// Whether a value may begin with a hyphen.
    pub hyphen: bool,
    /// Whether a wrong value is bad input, not wrong usage: values with a grammar of their own.
    pub grammar: bool,
    /// Changes a scenario; an error states the text and what is expected.
    pub set: fn(&mut Scenario, &str) -> Result<(), TextError>,
}

/// A setting with the most usual properties.
const PLAIN: Setting = Setting {
    name: "",
    key: "",
    long_name: "",
    value: "",
    help: "",
    default: None,
    alone: None,
    words: &[],
    required: false,
    repeats: false,
    hyphen: true,
    grammar: false,
    set: |_, _| Ok(()),
};

impl Setting {
    /// What it is, in a few words.
    pub fn about(&self) -> String {
        if self.long_name.is_empty() { self.name.replace('-', " ") } else { self.long_name.into() }
    }

    /// The unit of its numbers, as the end of the key and in the form of UDUNITS; `None` without one.
    pub fn unit(&self) -> Option<(&'static str, &'static str)> {
        unit_of(self.key)
    }
}

/// The setting of a scenario's conditions with this name.
pub fn of_name(name: &str) -> Option<&'static Setting> {
    CONDITIONS.iter().find(|setting| setting.name == name)
}

/// The setting with this key in a scenario's file.
pub fn of_key(key: &str) -> Option<&'static Setting> {
    [CONDITIONS, SEARCH, ADAPTIVE, START, PLANE, UNCERTAIN]
        .into_iter()
        .flatten()
        .find(|setting| setting.key == key)
}
