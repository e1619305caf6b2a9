//! Errors of the values of settings in text form.

use super::plant_error::UnknownSensorError;
use super::setting::DRAWS;
use super::speeds::SpeedsError;
use crate::plant::FaultTextError;
use crate::range::{RangeError, TimeError};

/// A text that is no value of its setting.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TextError {
    /// A text of another form.
    #[error("`{text}` is {wrong}")]
    Form {
        /// The text.
        text: String,
        /// Its fault, with the expected form.
        wrong: &'static str,
    },
    /// A word that is not in the setting's list.
    #[error(transparent)]
    Word(#[from] serde::de::value::Error),
    /// Not a key and its value.
    #[error("expected KEY=VALUE")]
    Pair,
    /// An unknown key.
    #[error("unknown key `{key}`{place}; expected {known}")]
    Key {
        /// The key.
        key: String,
        /// Where it is given, with a space before it, or nothing.
        place: &'static str,
        /// The known keys.
        known: &'static str,
    },
    /// A key whose value is no number.
    #[error("{key}: `{value}` is not a number")]
    Number {
        /// The key.
        key: String,
        /// Its value.
        value: String,
    },
    /// An unknown sensor.
    #[error(transparent)]
    Sensor(#[from] UnknownSensorError),
    /// A wrong fault.
    #[error(transparent)]
    Fault(#[from] FaultTextError),
    /// A wrong time.
    #[error(transparent)]
    Time(#[from] TimeError),
    /// A value outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// Wrong speeds.
    #[error(transparent)]
    Speeds(#[from] SpeedsError),
    /// A time of lying flat for a fall criterion without the flat angle.
    #[error("lasting needs flat=ANGLE; it cannot be combined with flat=none")]
    Lasting,
    /// A seed that TOML does not have.
    #[error("`{0}` is not a whole number from 0 to {most}", most = i64::MAX)]
    Seed(String),
    /// A number of drawn bicycles or riders outside its range.
    #[error("{0} is not in {least}..={most}", least = DRAWS.start(), most = DRAWS.end())]
    Draws(String),
}
