//! Errors of scenarios.

use super::blame::{bounds, conditions_key, number, search_key};
use super::file::SyntaxError;
use super::law::LawChoiceError;
use super::parameter_file::ParameterFileError;
use super::plant_error::PlantChoiceError;
use crate::basin::SearchError;
use crate::bicycle::catalogue::BicycleError;
use crate::bicycle::{ParameterError, SetError};
use crate::parameters::Rejected;
use crate::plant::PlantError;
use crate::range::RangeError;
use crate::ride::ConditionsError;
use crate::rider::{RiderError, ScheduleError};
use control::param::ParamError;
use std::error::Error;
use std::path::PathBuf;

/// A scenario that can't be read or resolved, with the reason.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ScenarioError {
    /// The scenario's file can't be read.
    #[error("can't read scenario {path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The operating system's error.
        source: std::io::Error,
    },
    /// The file is not TOML or JSON, or a key is unknown or of a wrong type.
    #[error("scenario {path}: {reason}")]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The parser's message, with line or key.
        reason: SyntaxError,
    },
    /// The bicycle can't be loaded.
    #[error(transparent)]
    Bicycle(#[from] BicycleError),
    /// The rider can't be loaded.
    #[error(transparent)]
    Rider(#[from] RiderError),
    /// One value is wrong.
    #[error("{key}: {reason}")]
    Value {
        /// The scenario's key, with dots.
        key: String,
        /// The value and its range.
        reason: Box<dyn Error + Send + Sync>,
    },
    /// The law can't be loaded.
    #[error(transparent)]
    Law(#[from] LawChoiceError),
    /// The file of the firmware's parameters can't be used.
    #[error(transparent)]
    ParameterFile(#[from] ParameterFileError),
    /// The file of a sensor or motor can't be loaded.
    #[error(transparent)]
    PlantFile(#[from] PlantChoiceError),
    /// A value of sensors, motor or faults is outside its range.
    #[error(transparent)]
    Plant(#[from] PlantError),
    /// A value of the search is outside its range.
    #[error(transparent)]
    Search(#[from] SearchError),
    /// Conditions that can't be ridden.
    #[error(transparent)]
    Conditions(#[from] ConditionsError),
    /// The rider's gains can't be fitted.
    #[error("rider `{table}`, gains {gains}: {error}")]
    Fit {
        /// The rider's table.
        table: String,
        /// The fit.
        gains: &'static str,
        /// The error.
        error: ScheduleError,
    },
    /// A parameter of the firmware is outside its range.
    #[error(transparent)]
    Parameter(#[from] ParamError),
    /// The bicycle is outside the range of the firmware's estimator.
    #[error(
        "{bicycle}: for the flashed code {error}, and capsize, predict and track need it; --assist ideal leaves the \
         flashed code out"
    )]
    Flashed {
        /// The bicycle.
        bicycle: String,
        /// The error.
        error: ParamError,
    },
}

impl ScenarioError {
    /// The key to blame, with dots, if it is known.
    pub fn key(&self) -> Option<String> {
        match self {
            Self::Syntax { reason, .. } => reason.key().map(Into::into),
            Self::Value { key, reason } if reason.is::<Rejected>() => {
                reason.downcast_ref().map(|Rejected { key: inner, .. }| format!("{key}.{inner}"))
            }
            Self::Value { key, reason } => Some(match reason.downcast_ref() {
                Some(SetError::Parameter(ParameterError::Range { key: inner, .. })) if key == "bicycle" => {
                    format!("bicycle.parameters.{inner}")
                }
                _ => self.number().and_then(|error| error.key).unwrap_or(key).to_owned(),
            }),
            Self::Bicycle(_) => Some("bicycle".into()),
            Self::Rider(_) | Self::Fit { .. } => Some("rider".into()),
            Self::Law(_) => Some("law".into()),
            Self::ParameterFile(_) => Some("parameter_file".into()),
            Self::Plant(_) => Some(self.number().and_then(|error| error.key).unwrap_or("plant").into()),
            Self::PlantFile(_) => Some("plant".into()),
            Self::Search(error) => Some(search_key(error).into()),
            Self::Parameter(error) => Some(format!("parameters.{}.{}", error.leaf.group, error.leaf.name)),
            Self::Conditions(error) => conditions_key(error).map(Into::into),
            Self::Flashed { .. } => Some("bicycle".into()),
            Self::Read { .. } => None,
        }
    }

    /// Smallest and largest allowed value, if a number is outside its range.
    pub fn range(&self) -> Option<(f64, f64)> {
        match self {
            Self::Value { reason, .. } => bounds(reason.as_ref()),
            Self::Parameter(error) | Self::Flashed { error, .. } => bounds(error),
            _ => self.number().map(RangeError::bounds),
        }
    }

    /// The number outside its range, if there is one.
    fn number(&self) -> Option<&RangeError> {
        match self {
            Self::Value { reason, .. } => number(reason.as_ref()),
            Self::Search(error) => error.range(),
            Self::Conditions(error) => error.range(),
            Self::Plant(PlantError::Range(error)) => Some(error),
            _ => None,
        }
    }

    /// The value of `key` is wrong.
    pub(crate) fn value(key: &str, reason: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::Value { key: key.into(), reason: reason.into() }
    }
}
