//! Errors of commands in the words of the command line.

use super::{Failure, UsageError};
use crate::commands::CommandError;
use crate::scenario::Scenario;
pub(super) use crate::scenario::named;

/// An error of a command; see [`named`].
pub(super) fn failure(scenario: &Scenario, error: CommandError) -> Failure {
    match error {
        CommandError::Scenario(error) => named(scenario, &error).into(),
        CommandError::Search(error) => named(scenario, &error.into()).into(),
        CommandError::Choice { name, reason } => format!("--{name}: {reason}").into(),
        CommandError::Idle { name, reason } => UsageError(format!("--{name}: {reason}")).into(),
        other => other.into(),
    }
}
