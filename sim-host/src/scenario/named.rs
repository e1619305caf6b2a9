//! Errors of a scenario, with the file or the option of the wrong value.

use super::{Scenario, ScenarioError, setting};

/// An error of a scenario. A value of the scenario's file is named by the file and the key, a value of an option by the
/// option. Of a value that a file and options can both contain, the file and the option are named.
pub fn named(scenario: &Scenario, error: &ScenarioError) -> String {
    let key = match error {
        ScenarioError::Value { .. }
        | ScenarioError::Search(_)
        | ScenarioError::Conditions(_)
        | ScenarioError::Plant(_) => error.key(),
        _ => None,
    };
    let outer = match error {
        ScenarioError::Value { key, .. } => setting::of_key(key),
        _ => None,
    };
    let setting = key.as_deref().and_then(setting::of_key).or(outer);
    let typed = setting.is_some_and(|setting| scenario.options.contains(setting.key));
    let of_option = typed || scenario.file.is_none();
    let text = match (error, setting) {
        (ScenarioError::Value { reason, .. }, Some(setting)) if of_option => {
            let colon = if setting.grammar { "" } else { ":" };
            format!("--{}{colon} {reason}", setting.name)
        }
        (ScenarioError::Value { .. }, _) | (_, None) => error.to_string(),
        (_, Some(setting)) if of_option => format!("--{}: {error}", setting.name),
        (_, Some(setting)) => format!("{}: {error}", setting.key),
    };
    match &scenario.file {
        Some(path) if !typed || setting.is_some_and(|setting| setting.repeats) => {
            format!("scenario {}: {text}", path.display())
        }
        _ => text,
    }
}
