//! Scenarios from Python.

use crate::error::{of_scenario, of_syntax};
use crate::law::OwnFunction;
use pyo3::prelude::*;
use serde::de::DeserializeOwned;
use sim_host::commands::Setup;
use sim_host::scenario::{Scenario, choices, unit_of as unit};
use std::path::PathBuf;

/// A scenario from JSON.
pub(crate) fn parsed(py: Python<'_>, json: &str) -> PyResult<Scenario> {
    Scenario::from_json(json).map_err(|error| of_syntax(py, &error))
}

/// Choices beside a scenario, from JSON.
pub(crate) fn chosen<T: DeserializeOwned>(py: Python<'_>, json: &str) -> PyResult<T> {
    choices(json).map_err(|error| of_syntax(py, &error))
}

/// A loaded scenario, steered by `law` if one is given.
pub(crate) fn setup(py: Python<'_>, json: &str, law: Option<&OwnFunction>) -> PyResult<Setup> {
    let scenario = parsed(py, json)?;
    let setup = match law {
        Some(law) => Setup::steered_by(&scenario, &law.name, law.law()),
        None => Setup::new(&scenario),
    };
    setup.map_err(|error| of_scenario(py, &error))
}

/// Reads a scenario file, TOML or JSON, or the scenario of a result; returns it as JSON.
#[pyfunction]
pub(crate) fn read(py: Python<'_>, path: PathBuf) -> PyResult<String> {
    let scenario = Scenario::read(&path).map_err(|error| of_scenario(py, &error))?;
    Ok(json(&scenario))
}

/// Loads and checks a scenario; returns it with the contents of files in the places of their names, its conditions, and its
/// warnings and notes.
#[pyfunction]
pub(crate) fn check(py: Python<'_>, scenario: &str) -> PyResult<(String, String, Vec<String>, Vec<String>)> {
    let setup = setup(py, scenario, None)?;
    Ok((json(&setup.scenario), json(&setup.config), setup.warnings().collect(), setup.notes))
}

/// The unit of a number called `name`, from the end of the name; 1 without one.
#[pyfunction]
pub(crate) fn unit_of(name: &str) -> &'static str {
    unit(name).map_or("1", |(_, unit)| unit)
}

/// A value as JSON.
pub(crate) fn json(value: &impl serde::Serialize) -> String {
    // Documents have no keys but text, so this cannot fail.
    serde_json::to_string(value).unwrap_or_default()
}
