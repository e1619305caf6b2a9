//! What is shipped.

use pyo3::prelude::*;
use sim_host::bicycle::{KEYS, catalogue};
use sim_host::rider;

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
