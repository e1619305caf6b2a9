//! `sweep`: the plan, one cell, the document of all. The cells can be computed anywhere.

use crate::error::{of_choice, of_command, of_text};
use crate::scenario::{json, parsed};
use crate::work::{Options, run};
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sim_host::commands::sweep::{sweep, unit};
use sim_host::scenario::setting::{CONDITIONS, Setting, of_name};
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
    let axes = axes.map_err(|error| of_choice(py, &error.to_string(), error.key().map(key_of), None))?;
    let task = py.detach(|| sweep(&axes, &base, Vec::new()));
    let task = task.map_err(|error| {
        let key = error.key();
        of_choice(py, &error.to_string(), key.as_deref().map(key_of), error.range())
    })?;
    let cell = |cell: sim_host::sweep::Cell| {
        let sim_host::sweep::Cell { id, config, scenario, .. } = cell;
        json(&CellTask { id, config, scenario })
    };
    Ok((json(&task.plan), task.cells.into_iter().map(cell).collect(), task.remarks.into_iter().collect()))
}

/// The key of the option with this name; a key is its own.
fn key_of(name: &str) -> &str {
    of_name(name).map_or(name, |setting| setting.key)
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

/// An axis of a sweep's document (JSON) as a coordinate: what it is, its unit, and its values if they are numbers.
#[pyfunction]
pub(crate) fn axis_coordinate(py: Python<'_>, axis: &str) -> PyResult<(String, String, Option<Vec<f64>>)> {
    let axis: Axis = serde_json::from_str(axis).map_err(|error| of_text(py, &error))?;
    let of_words = || of_name(&axis.key).and_then(Setting::unit).map_or("1", |(_, unit)| unit);
    let unit = axis.unit().map_or_else(of_words, |unit| unit.netcdf);
    Ok((axis.about(), unit.into(), axis.numbers().map(|(numbers, _)| numbers)))
}
