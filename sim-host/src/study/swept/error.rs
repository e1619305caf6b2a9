//! Errors of sweep studies.

use crate::sweep::AxisError;
use std::io;

/// A study that can't be loaded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// Neither a built-in study nor a file.
    #[error("unknown study `{name}`: no such file; shipped are {known}")]
    Unknown {
        /// As given.
        name: String,
        /// The built-in studies.
        known: String,
    },
    /// The file can't be read.
    #[error("can't read study file {name}: {error}")]
    Read {
        /// The file.
        name: String,
        /// The system's error.
        error: io::Error,
    },
    /// Not TOML, or a key is missing, unknown or of a wrong type.
    #[error("study {name}: {reason}")]
    Syntax {
        /// The file, or the built-in study.
        name: String,
        /// The parser's message.
        reason: String,
    },
    /// A wrong sweep.
    #[error("study {name}: sweep {sweep}: {error}")]
    Part {
        /// The file, or the built-in study.
        name: String,
        /// The sweep.
        sweep: String,
        /// The error.
        error: Box<PartError>,
    },
}

/// A wrong sweep of a study.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PartError {
    /// An option that does not exist.
    #[error("options: unknown option `{name}`; there are {known}")]
    Option {
        /// As given.
        name: String,
        /// The options.
        known: String,
    },
    /// Several values of an option that has one.
    #[error("options: `{0}` can be given once only, not as a list")]
    Once(&'static str),
    /// A name that is no name of a file.
    #[error("a name is of letters, digits and hyphens")]
    Name,
    /// An invalid axis.
    #[error(transparent)]
    Axis(#[from] AxisError),
    /// A value of the reference that no axis has.
    #[error("reference: no axis has {key}={value}")]
    Reference {
        /// The axis.
        key: String,
        /// The value.
        value: String,
    },
    /// The compared axis is not in the reference.
    #[error("along = `{0}` is not in the reference")]
    Along(String),
    /// Too many axes.
    #[error("a reference of more than three axes can't be shown as a table")]
    Large,
}
