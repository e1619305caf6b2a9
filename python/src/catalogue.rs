//! What is shipped.

use crate::error::of_key;
use crate::scenario::json;
use pyo3::prelude::*;
use sim_host::bicycle::{KEYS, catalogue};
use sim_host::rider;
use std::path::Path;

/// Names of the shipped bicycles.
#[pyfunction]
pub(crate) fn bicycles() -> Vec<String> {
    catalogue::shipped_names()
}

/// Names of the shipped riders.
#[pyfunction]
pub(crate) fn riders() -> Vec<String> {
    rider::catalogue::shipped_names().map(Into::into).collect()
}

/// Names of a bicycle's parameters, in their order.
#[pyfunction]
pub(crate) fn bicycle_keys() -> Vec<&'static str> {
    KEYS.to_vec()
}

/// The bicycle called `name` of a text in BicycleParameters' format, whose further keys are checked and left out: a
/// scenario's `bicycle` as JSON.
#[pyfunction]
pub(crate) fn bicycle_of_text(py: Python<'_>, name: &str, text: &str) -> PyResult<String> {
    let bicycle = catalogue::from_text(name, text, Path::new(&format!("{name}.txt")), None);
    bicycle.map(|bicycle| json(&bicycle)).map_err(|error| of_key(py, "bicycle", &error))
}
