//! Errors of scenarios.

use crate::bicycle::catalogue::BicycleError;
use crate::rider::RiderError;
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
        reason: String,
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
        reason: String,
    },
    /// Values that can't be combined, or the file of one.
    #[error("{0}")]
    Conditions(String),
}

impl ScenarioError {
    /// The value of `key` is wrong.
    pub(super) fn value(key: &str, reason: impl ToString) -> Self {
        Self::Value { key: key.into(), reason: reason.to_string() }
    }
}
