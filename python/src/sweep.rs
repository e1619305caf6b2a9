//! `sweep`: the plan, one cell, the document of all. The cells can be computed anywhere.

use crate::error::{of_command, of_text};
use crate::scenario::{json, parsed};
use crate::work::{Options, run};
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sim_host::commands::sweep::{sweep, unit};
use sim_host::scenario::setting::CONDITIONS;
use sim_host::sweep::document::SweepDocument;
use sim_host::sweep::{Axis, Grid, Plan, Unit};

/// A cell as it goes to a worker.
#[derive(Serialize, Deserialize)]
struct CellTask {
    id: String,
    config: Value,
    scenario: Value,
}

/// The plan of a sweep over `axes` (text of the form KEY=VALUES) as JSON, its cells as JSON, and its warnings and notes.
#[pyfunction]
pub(crate) fn sweep_plan(
    py: Python<'_>,
    scenario: &str,
    axes: Vec<String>,
) -> PyResult<(String, Vec<String>, Vec<String>)> {
    let base = parsed(py, scenario)?;
    let axes = axes.iter().map(|axis| Axis::parse(axis)).collect::<Result<Vec<_>, _>>();
    let axes = axes.map_err(|error| of_text(py, &error))?;
    let task = py.detach(|| sweep(&axes, &base, Vec::new())).map_err(|error| of_command(py, &error))?;
    let cell = |cell: sim_host::sweep::Cell| {
        let sim_host::sweep::Cell { id, config, scenario, .. } = cell;
        json(&CellTask { id, config, scenario })
    };
    Ok((json(&task.plan), task.cells.into_iter().map(cell).collect(), task.remarks.into_iter().collect()))
}

/// Computes a cell: its result as JSON (`None` after an interruption), and whether it was interrupted.
#[pyfunction]
#[pyo3(signature = (cell, threads=None, progress=None))]
pub(crate) fn sweep_cell<'py>(
    py: Python<'py>,
    cell: &str,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Option<String>, bool)> {
    let CellTask { id, config, scenario } =
        serde_json::from_str(cell).map_err(|error| of_text(py, &error))?;
    let options = Options { parts: 0, threads, progress, law: None };
    let (unit, interrupted) = run(py, &options, |hooks| unit(&id, &config, &scenario, hooks))?;
    let unit = unit.map_err(|error| of_command(py, &error))?;
    Ok((unit.as_ref().map(json), interrupted))
}

/// The document of a sweep from its plan and the results of its cells, in any order; cells can be missing.
#[pyfunction]
pub(crate) fn sweep_document(py: Python<'_>, plan: &str, units: Vec<String>) -> PyResult<String> {
    let plan: Plan = serde_json::from_str(plan).map_err(|error| of_text(py, &error))?;
    let units = units.iter().map(|unit| serde_json::from_str::<Unit>(unit)).collect::<Result<Vec<_>, _>>();
    let units = units.map_err(|error| of_text(py, &error))?;
    let of_cell = |id: &String| units.iter().find(|unit| unit.id == *id).cloned();
    let units = plan.cells.iter().map(of_cell).collect();
    Ok(json(&SweepDocument::new(&Grid { plan, units })))
}

/// The keys of a scenario that can be an axis, each with the name of its setting.
#[pyfunction]
pub(crate) fn axes() -> Vec<(&'static str, &'static str)> {
    CONDITIONS.iter().map(|setting| (setting.key, setting.name)).collect()
}
