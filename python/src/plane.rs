//! `plane`.

use crate::error::of_command;
use crate::law::{Given, OwnFunction};
use crate::scenario::{json, setup};
use crate::work::{Options, run};
use pyo3::prelude::*;
use sim_host::commands::plane::plane as search_plane;

/// Searches a basin over both rates: the document as JSON, and whether it was interrupted.
#[pyfunction]
#[pyo3(signature = (scenario, law=None, threads=None, progress=None))]
pub(crate) fn plane<'py>(
    py: Python<'py>,
    scenario: &str,
    law: Option<Given<'py>>,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(String, bool)> {
    let law = law.map(OwnFunction::new);
    let setup = setup(py, scenario, law.as_ref())?;
    let parts = setup.scenario.plane.map_or(0, |search| search.rays);
    let options = Options { parts, threads, progress, law: law.as_ref() };
    let (found, interrupted) = run(py, &options, |hooks| search_plane(&setup, hooks))?;
    let found = found.map_err(|error| of_command(py, &error))?;
    Ok((json(&found.document(&setup)), interrupted))
}
