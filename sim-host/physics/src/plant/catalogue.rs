//! Loads actuators by name or from TOML files.

use super::{ActuatorConfig, PlantError};
use serde::Deserialize;
use std::path::Path;

/// The shipped actuators, one table each.
const SHIPPED: &str = include_str!("../../../../data/actuators.toml");

/// Names of the shipped actuators; "none" is the exact one.
pub fn shipped_names() -> Vec<String> {
    let shipped: toml::Table = toml::from_str(SHIPPED).unwrap_or_default();
    std::iter::once("none".into()).chain(shipped.keys().cloned()).collect()
}

/// An actuator that can't be loaded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ActuatorFileError {
    /// Neither a shipped name nor a file.
    #[error("unknown actuator `{name}`: no such file, and not one of {known}")]
    Unknown {
        /// As given.
        name: String,
        /// The shipped names.
        known: String,
    },
    /// The file can't be read.
    #[error("can't read actuator file {name}: {error}")]
    Read {
        /// The file.
        name: String,
        /// The system's error.
        error: String,
    },
    /// The file is not TOML, or a key is missing, unknown or of a wrong type.
    #[error("actuator file {name}: {reason}")]
    Syntax {
        /// The file.
        name: String,
        /// The parser's message.
        reason: String,
    },
    /// The file has no key.
    #[error(
        "actuator file {name}: there is no value in it; expected one or more, for example limit_nm = 12 (docs/plant.md); \
         the exact motor is none"
    )]
    Empty {
        /// The file.
        name: String,
    },
    /// A value is wrong.
    #[error("actuator file {name}: {error}")]
    Value {
        /// The file.
        name: String,
        /// The value and its range.
        error: PlantError,
    },
}

/// Loads an actuator by shipped name, otherwise from a file.
///
/// # Errors
/// An unknown name or file, a missing or unknown key, a wrong type, or a value out of range; each is named.
pub fn load(name: &str) -> Result<ActuatorConfig, ActuatorFileError> {
    if name == "none" {
        return Ok(ActuatorConfig::default());
    }
    let fail = |reason: String| ActuatorFileError::Syntax { name: name.into(), reason: reason.trim().into() };
    let mut shipped: toml::Table = toml::from_str(SHIPPED).unwrap_or_default();
    let mut table = match shipped.remove(name) {
        Some(toml::Value::Table(table)) => table,
        _ if !Path::new(name).exists() => {
            let known = shipped_names().join(", ");
            return Err(ActuatorFileError::Unknown { name: name.into(), known });
        }
        _ => {
            let text = crate::input_file::text(Path::new(name))
                .map_err(|e| ActuatorFileError::Read { name: name.into(), error: e.to_string() })?;
            toml::from_str(&text).map_err(|e| fail(e.to_string()))?
        }
    };
    if table.remove("source").is_some_and(|source| !source.is_str()) {
        return Err(fail("source must be text".into()));
    }
    if table.is_empty() {
        return Err(ActuatorFileError::Empty { name: name.into() });
    }
    let config = ActuatorConfig::deserialize(table).map_err(|e| fail(e.to_string()))?;
    config.check().map_err(|error| ActuatorFileError::Value { name: name.into(), error })?;
    Ok(config)
}
