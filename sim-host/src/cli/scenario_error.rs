//! Errors of a scenario, with the file or the option of the wrong value.

use crate::scenario::{Scenario, ScenarioError, setting};

/// An error of a scenario, with its file.
pub(super) fn of_file(scenario: &Scenario, error: &ScenarioError) -> String {
    match &scenario.file {
        Some(path) => format!("scenario {}: {}", path.display(), named(error)),
        None => named(error),
    }
}

/// An error of a scenario, with the option that sets its key.
pub(super) fn named(error: &ScenarioError) -> String {
    match error {
        ScenarioError::Value { key, reason } => match setting::of_key(key) {
            Some(setting) if setting.grammar => format!("--{} {reason}", setting.name),
            Some(setting) => format!("--{}: {reason}", setting.name),
            None => error.to_string(),
        },
        _ => error.to_string(),
    }
}
