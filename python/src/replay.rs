//! `replay`.

use crate::error::{of_command, of_text};
use crate::scenario::json;
use crate::work::{Options, run};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use serde::Deserialize;
use sim_host::commands::replay::{Replay, ReplayChoice};
use sim_host::replay::Resample;
use sim_host::scenario::Preset;
use std::path::PathBuf;

/// Choices of a replay.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Choice {
    map: Option<String>,
    dbc: Vec<PathBuf>,
    strict: bool,
    resample: Option<Resample>,
    longest_gap_s: f64,
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
        let ReplayChoice { longest_gap_s, preset, every_s, .. } = ReplayChoice::default();
        Self {
            map: None,
            dbc: Vec::new(),
            strict: false,
            resample: None,
            longest_gap_s,
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

/// Replays a recording: the document and the rows of the table as JSON, and the doubts.
#[pyfunction]
pub(crate) fn replay(py: Python<'_>, file: PathBuf, choice: &str) -> PyResult<(String, String, Vec<String>)> {
    let choice: Choice = serde_json::from_str(choice).map_err(|error| of_text(py, &error))?;
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
    let replay = Replay::new(choice).map_err(|error| of_command(py, &error))?;
    let options = Options { parts: 1, threads: Some(1), progress: None, law: None };
    let (done, interrupted) = run(py, &options, |_| replay.file(&file))?;
    if interrupted {
        return Err(PyKeyboardInterrupt::new_err("the replay was interrupted"));
    }
    let done = done.map_err(|error| of_text(py, &error))?;
    Ok((json(&done.document()), json(&done.result.replayed.rows), replay.remarks))
}
