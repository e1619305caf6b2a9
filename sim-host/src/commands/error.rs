//! Errors of commands.

use crate::basin::SearchError;
use crate::eigen::ActuatorError;
use crate::scenario::ScenarioError;
use crate::sweep::SweepError;
use std::error::Error;

/// A command that can't be run, with the reason.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CommandError {
    /// The scenario can't be used.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The search can't be done.
    #[error(transparent)]
    Search(#[from] SearchError),
    /// The actuator of an eigenvalue analysis can't be used.
    #[error(transparent)]
    Actuator(#[from] ActuatorError),
    /// A choice beside the scenario is wrong.
    #[error("{name}: {reason}")]
    Choice {
        /// Its name, which is that of the option.
        name: &'static str,
        /// The value and what is allowed.
        reason: Box<dyn Error + Send + Sync>,
    },
    /// The axes of a sweep can't be used.
    #[error(transparent)]
    Sweep(#[from] SweepError),
    /// A cell of a sweep is wrong; its values and the reason as text.
    #[error("{0}")]
    Cell(String),
    /// Conditions that distinguish left from right, in a search that mirrors one half.
    #[error("basin plane mirrors one half: no faults, noise, bias, dropout, no IMU off its middle")]
    OneSided,
}

impl CommandError {
    /// The choice `name` is wrong.
    pub(crate) fn choice(name: &'static str, reason: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::Choice { name, reason: reason.into() }
    }
}
