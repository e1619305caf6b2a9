//! Errors of commands.

use crate::basin::SearchError;
use crate::eigen::{ActuatorError, SEARCH_TO_M_S};
use crate::range::RangeError;
use crate::scenario::{ScenarioError, bounds, number, search_key};
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
    /// The bicycle with what steers it is too far from any real one.
    #[error(
        "no eigenvalue converges at a speed up to {SEARCH_TO_M_S} m/s or a requested one: bicycle, law, rider or actuator are too extreme"
    )]
    NoEigenvalue,
    /// A choice beside the scenario is wrong.
    #[error("{name}: {reason}")]
    Choice {
        /// Its name, which is that of the option.
        name: &'static str,
        /// The value and what is allowed.
        reason: Box<dyn Error + Send + Sync>,
    },
    /// A choice beside the scenario has no effect on it.
    #[error("{name}: {reason}")]
    Idle {
        /// Its name, which is that of the option.
        name: &'static str,
        /// Why it has none.
        reason: &'static str,
    },
    /// The axes of a sweep can't be used.
    #[error(transparent)]
    Sweep(#[from] SweepError),
    /// A sweep has too many cells.
    #[error("the sweep has {cells} cells; at most {most}")]
    Cells {
        /// The number of cells.
        cells: usize,
        /// The largest number.
        most: usize,
    },
    /// A cell of a sweep is wrong.
    #[error("cell {cell}: {message}")]
    Cell {
        /// Its values.
        cell: String,
        /// The reason.
        message: String,
        /// The scenario's key to blame, with dots, if it is known.
        key: Option<String>,
        /// Smallest and largest allowed value, if a number is outside its range.
        range: Option<(f64, f64)>,
    },
    /// Conditions that distinguish left from right, in a search that mirrors one half.
    #[error("basin plane mirrors one half: no faults, noise, bias, dropout, no IMU off its middle")]
    OneSided,
}

impl CommandError {
    /// The scenario's key or the choice to blame, if it is known.
    pub fn key(&self) -> Option<String> {
        match self {
            Self::Scenario(error) => error.key(),
            Self::Search(error) => Some(search_key(error).into()),
            Self::Actuator(ActuatorError::Range(error)) => error.key.map(Into::into),
            Self::Actuator(ActuatorError::TwoDelays) => Some("actuator.delay_s".into()),
            Self::Choice { name, reason } => {
                Some(number(reason.as_ref()).and_then(|error| error.key).unwrap_or(name).into())
            }
            Self::Idle { name, .. } => Some((*name).into()),
            Self::Sweep(error) => error.key().map(Into::into),
            Self::Cells { .. } | Self::NoEigenvalue => None,
            Self::Cell { key, .. } => key.clone(),
            Self::OneSided => Some("plant".into()),
        }
    }

    /// Smallest and largest allowed value, if a number is outside its range.
    pub fn range(&self) -> Option<(f64, f64)> {
        match self {
            Self::Scenario(error) => error.range(),
            Self::Search(error) => error.range().map(RangeError::bounds),
            Self::Actuator(ActuatorError::Range(error)) => Some(error.bounds()),
            Self::Choice { reason, .. } => bounds(reason.as_ref()),
            Self::Cell { range, .. } => *range,
            _ => None,
        }
    }

    /// The choice `name` is wrong.
    pub(crate) fn choice(name: &'static str, reason: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::Choice { name, reason: reason.into() }
    }
}
