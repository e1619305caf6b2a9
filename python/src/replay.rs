//! `replay`.

use crate::error::{of_choice, of_renamed};
use crate::flags;
use crate::scenario::{chosen, json};
use crate::work::{Options, run};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde::Deserialize;
use sim_host::commands::CommandError;
use sim_host::commands::replay::{Replay, ReplayChoice};
use sim_host::replay::Resample;
use sim_host::scenario::Preset;
use std::path::PathBuf;

/// Options whose argument has another name.
const NAMES: [(&str, &str); 2] = [("fault", "faults"), ("parameter_file", "parameters")];

/// Choices of a replay.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Choice {
    map: Option<String>,
    dbc: Vec<PathBuf>,
    strict: bool,
    resample: Option<Resample>,
    longest_gap_s: Option<f64>,
    preset: Preset,
    law: Option<String>,
    bicycle: Option<String>,
    parameters: Option<PathBuf>,
    set: Vec<String>,
    faults: Vec<String>,
    seed: u64,
    every_s: f64,
}

impl Default for Choice {
    fn default() -> Self {
        let ReplayChoice { preset, every_s, .. } = ReplayChoice::default();
        Self {
            map: None,
            dbc: Vec::new(),
            strict: false,
            resample: None,
            longest_gap_s: None,
            preset,
            law: None,
            bicycle: None,
            parameters: None,
            set: Vec::new(),
            faults: Vec::new(),
            seed: 0,
            every_s,
        }
    }
}

/// A replay: the document and the rows of the table as JSON, `limit_active` and `cause_active` of the rows as one byte per flag,
/// and the doubts.
type Replayed<'py> = (String, String, (Bound<'py, PyBytes>, Bound<'py, PyBytes>), Vec<String>);

/// Replays a recording: the document and the rows of the table as JSON, the flags of the rows, and the doubts.
#[pyfunction]
pub(crate) fn replay<'py>(py: Python<'py>, file: PathBuf, choice: &str) -> PyResult<Replayed<'py>> {
    let choice: Choice = chosen(py, choice)?;
    let choice = ReplayChoice {
        map: choice.map,
        dbc: choice.dbc,
        strict: choice.strict,
        resample: choice.resample,
        longest_gap_s: choice.longest_gap_s,
        preset: choice.preset,
        law: choice.law,
        bicycle: choice.bicycle,
        parameters: choice.parameters,
        set: choice.set,
        faults: choice.faults,
        seed: choice.seed,
        every_s: choice.every_s,
        ..ReplayChoice::default()
    };
    let replay = Replay::new(choice).map_err(|error| of_renamed(py, &error, &NAMES))?;
    let options = Options { parts: 1, threads: Some(1), progress: None, law: None };
    let (done, interrupted) = run(py, &options, |hooks| replay.file_until(&file, hooks.stop))?;
    if interrupted {
        return Err(PyKeyboardInterrupt::new_err("the replay was interrupted"));
    }
    let done = done.map_err(|error| match error.downcast_ref::<CommandError>() {
        Some(error) => of_renamed(py, error, &NAMES),
        None => of_choice(py, &error.to_string(), None, None),
    })?;
    let rows = &done.result.replayed.rows;
    let active = (
        flags::limits(py, rows.iter().map(|row| row.limits)),
        flags::causes(py, rows.iter().map(|row| row.causes)),
    );
    let warnings = [replay.remarks, done.result.without_effect.clone()].concat();
    Ok((json(&done.document()), json(rows), active, warnings))
}
