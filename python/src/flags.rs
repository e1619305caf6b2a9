//! Modes, limits and causes as flags: a byte each, with the names of the NetCDF files.

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use sim_host::report::netcdf::{ACTIVE, active_causes, active_limits, cause_names, limit_names, mode_names};

/// Names of the modes, of the two states of a limit or cause, and of the limits; names and numbers of the causes.
type Names = (Vec<String>, [&'static str; 2], Vec<String>, Vec<(String, u8)>);

/// Names of the modes, of the two states of a limit or cause, and of the limits; names and numbers of the causes.
#[pyfunction]
pub(crate) fn flags() -> Names {
    (mode_names(), ACTIVE, limit_names(), cause_names())
}

/// Whether each limit is active, a byte each, the limits of the first bits first.
pub(crate) fn limits<'py>(py: Python<'py>, bits: impl Iterator<Item = u16>) -> Bound<'py, PyBytes> {
    bytes(py, bits.flat_map(active_limits))
}

/// Whether each cause is active, a byte each, the causes of the first bits first.
pub(crate) fn causes<'py>(py: Python<'py>, bits: impl Iterator<Item = u64>) -> Bound<'py, PyBytes> {
    bytes(py, bits.flat_map(active_causes))
}

fn bytes<'py>(py: Python<'py>, flags: impl Iterator<Item = bool>) -> Bound<'py, PyBytes> {
    PyBytes::new(py, &flags.map(u8::from).collect::<Vec<_>>())
}
