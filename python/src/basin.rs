//! `basin`.

use crate::error::{of_command, of_scenario};
use crate::law::{Given, OwnFunction};
use crate::scenario::{json, setup};
use crate::work::{Options, run};
use pyo3::prelude::*;
use sim_host::commands::basin::BasinTask;

/// Searches a basin: the document as JSON, and whether it was interrupted.
#[pyfunction]
#[pyo3(signature = (scenario, law=None, threads=None, progress=None))]
pub(crate) fn basin<'py>(
    py: Python<'py>,
    scenario: &str,
    law: Option<Given<'py>>,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(String, bool)> {
    let law = law.map(OwnFunction::new);
    let setup = setup(py, scenario, law.as_ref())?;
    let task = BasinTask::new(setup).map_err(|error| of_scenario(py, &error))?;
    let options = Options { parts: task.columns(), threads, progress, law: law.as_ref() };
    let (found, interrupted) = run(py, &options, |hooks| task.run(false, |_| (), hooks))?;
    let found = found.map_err(|error| of_command(py, &error.into()))?;
    Ok((py.detach(|| json(&found.document(&task.setup))), interrupted))
}
