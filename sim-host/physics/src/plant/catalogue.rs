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

/// Loads an actuator by shipped name, otherwise from a file.
///
/// # Errors
/// An unknown name or file, a missing or unknown key, a wrong type, or a value out of range; each is named.
pub fn load(name: &str) -> Result<ActuatorConfig, PlantError> {
    if name == "none" {
        return Ok(ActuatorConfig::default());
    }
    let fail = |reason: String| PlantError(format!("actuator file {name}: {}", reason.trim()));
    let mut shipped: toml::Table = toml::from_str(SHIPPED).unwrap_or_default();
    let mut table = match shipped.remove(name) {
        Some(toml::Value::Table(table)) => table,
        _ if !Path::new(name).exists() => {
            return Err(PlantError(format!(
                "unknown actuator `{name}`: no such file, and not one of {}",
                shipped_names().join(", ")
            )));
        }
        _ => {
            let text = std::fs::read_to_string(name)
                .map_err(|e| PlantError(format!("can't read actuator file {name}: {e}")))?;
            toml::from_str(&text).map_err(|e| fail(e.to_string()))?
        }
    };
    if table.remove("source").is_some_and(|source| !source.is_str()) {
        return Err(fail("source must be text".into()));
    }
    let config = ActuatorConfig::deserialize(table).map_err(|e| fail(e.to_string()))?;
    config.check().map_err(|e| fail(e.0))?;
    Ok(config)
}
