//! A setting with a value, as a text.

use super::Setting;
use crate::scenario::{Scenario, TextError, bounds};

/// A setting and its text.
#[derive(Clone, Debug)]
pub struct Given {
    /// The setting.
    pub setting: &'static Setting,
    /// Its value, in the form of the option.
    pub text: String,
}

/// A text that is no value of its setting.
#[derive(Clone, Debug, thiserror::Error)]
#[error("--{} {}: {reason}", given.setting.name, given.text)]
pub struct GivenError {
    /// The setting and its text.
    pub given: Given,
    /// What is expected.
    pub reason: Box<TextError>,
}

impl GivenError {
    /// Smallest and largest allowed value, if a number is outside its range.
    pub fn range(&self) -> Option<(f64, f64)> {
        bounds(self.reason.as_ref())
    }
}

impl Given {
    /// Changes a scenario.
    ///
    /// # Errors
    /// The option with its text, and what is expected.
    pub fn apply(&self, scenario: &mut Scenario) -> Result<(), GivenError> {
        scenario.options.insert(self.setting.key);
        (self.setting.set)(scenario, &self.text)
            .map_err(|reason| GivenError { given: self.clone(), reason: Box::new(reason) })
    }

    /// As it was typed.
    pub fn typed(&self) -> String {
        format!("--{}={}", self.setting.name, self.text)
    }
}
