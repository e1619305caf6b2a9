//! Errors of a scenario, with the file or the option of the wrong value.

use super::{Scenario, ScenarioError, setting};

/// An error of a scenario. A value of the scenario's file is named by the file and the key, a value of an option by the
/// option. Of a value that a file and options can both contain, the file and the option are named.
pub fn named(scenario: &Scenario, error: &ScenarioError) -> String {
    let setting = match error {
        ScenarioError::Value { key, .. } => setting::of_key(key),
        _ => None,
    };
    let typed = setting.is_some_and(|setting| scenario.options.contains(setting.key));
    let text = match (error, setting) {
        (ScenarioError::Value { reason, .. }, Some(setting)) if typed || scenario.file.is_none() => {
            let colon = if setting.grammar { "" } else { ":" };
            format!("--{}{colon} {reason}", setting.name)
        }
        _ => error.to_string(),
    };
    match &scenario.file {
        Some(path) if !typed || setting.is_some_and(|setting| setting.repeats) => {
            format!("scenario {}: {text}", path.display())
        }
        _ => text,
    }
}
