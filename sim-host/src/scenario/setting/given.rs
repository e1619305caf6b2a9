//! A setting with a value, as a text.

use super::Setting;
use crate::scenario::Scenario;

/// A setting and its text.
#[derive(Clone, Debug)]
pub struct Given {
    /// The setting.
    pub setting: &'static Setting,
    /// Its value, in the form of the option.
    pub text: String,
}

impl Given {
    /// Changes a scenario.
    ///
    /// # Errors
    /// The option with its text, and what is expected.
    pub fn apply(&self, scenario: &mut Scenario) -> Result<(), String> {
        scenario.options.insert(self.setting.key);
        (self.setting.set)(scenario, &self.text)
            .map_err(|e| format!("--{} {}: {e}", self.setting.name, self.text))
    }

    /// As it was typed.
    pub fn typed(&self) -> String {
        format!("--{}={}", self.setting.name, self.text)
    }
}
