//! `identify`.

use crate::error::{of_scenario, of_text};
use crate::scenario::{json, parsed};
use crate::work::{Options, run};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use serde::Deserialize;
use sim_host::bicycle::ForcePoint;
use sim_host::commands::identify::{Delay, IdentifyChoice, ready};
use sim_host::commands::identify_text::{drift, select};
use sim_host::identify::{Hold, Signal, Stage, symbols};
use sim_host::range::within;
use sim_host::recording::ReadOptions;
use sim_host::replay::Map;
use sim_host::rider::Neuromuscular;
use std::f64::consts::TAU;
use std::path::PathBuf;

/// Stages of an identification.
const STAGES: usize = 4;

/// Longest neural delay \[s\].
const LONGEST_S: f64 = 0.5;

/// Choices of an identification.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Choice {
    map: Option<String>,
    dbc: Vec<PathBuf>,
    speed_m_s: Option<f64>,
    force_at_m: Option<(f64, f64)>,
    fit: Option<Vec<Signal>>,
    gains: Vec<String>,
    neuromuscular: Option<(f64, f64)>,
    /// `None`: the likeliest.
    delay_s: Option<f64>,
    delay_profile_s: Vec<f64>,
    drift: Option<String>,
    skip_s: Option<f64>,
    hold: Option<Hold>,
    filter: bool,
    linear: bool,
    select: Option<String>,
    reduce: bool,
    seed: u64,
}

/// Identifies a rider from a record: the document as JSON, and the rider's table as TOML.
///
/// # Errors
/// What the record or the choices lack; Ctrl-C.
#[pyfunction]
#[pyo3(signature = (file, scenario, choice, threads=None, progress=None))]
pub(crate) fn identify<'py>(
    py: Python<'py>,
    file: PathBuf,
    scenario: &str,
    choice: &str,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(String, String)> {
    let bicycle = parsed(py, scenario)?.bicycle().map_err(|error| of_scenario(py, &error))?;
    let choice: Choice = serde_json::from_str(choice).map_err(|error| of_text(py, &error))?;
    let choice = chosen(choice, IdentifyChoice::new(bicycle)).map_err(|error| of_text(py, &error))?;
    let options = Options { parts: STAGES, threads, progress, law: None };
    let (found, interrupted) = run(py, &options, |hooks| {
        let begins = |_: Stage| (hooks.finished)();
        ready(&choice, &file)?.identify(&choice.bicycle, &begins, hooks.stop)
    })?;
    if interrupted {
        return Err(PyKeyboardInterrupt::new_err("the identification was interrupted"));
    }
    let found = found.map_err(|error| of_text(py, &format!("{}: {error}", file.display())))?;
    Ok((json(&found.document), found.rider.to_toml()))
}

/// The choices as the library has them.
fn chosen(choice: Choice, default: IdentifyChoice) -> Result<IdentifyChoice, String> {
    let text = |error: &dyn std::fmt::Display| error.to_string();
    let gain = |name: &String| {
        let place = symbols().iter().position(|symbol| symbol == name);
        place.ok_or_else(|| format!("gains: `{name}` is none of {}", symbols().join(", ")))
    };
    if let Some(delay_s) = choice.delay_s {
        within("delay_s", delay_s, 0.0, LONGEST_S).map_err(|e| text(&e))?;
    }
    let neuromuscular = choice.neuromuscular.map(|(hz, zeta)| Neuromuscular { omega_rad_s: hz * TAU, zeta });
    if let Some(muscles) = &neuromuscular {
        muscles.check().map_err(|e| format!("neuromuscular: {e}"))?;
    }
    Ok(IdentifyChoice {
        map: choice.map.as_deref().map(Map::load).transpose().map_err(|e| format!("map: {e}"))?,
        map_name: choice.map.clone().unwrap_or(default.map_name),
        read: ReadOptions { strict: false, dbc: choice.dbc },
        speed_m_s: choice.speed_m_s,
        force_at: choice
            .force_at_m
            .map_or(default.force_at, |(ahead_m, height_m)| ForcePoint { ahead_m, height_m }),
        fit: choice.fit.unwrap_or(default.fit),
        gains: choice.gains.iter().map(gain).collect::<Result<_, _>>()?,
        neuromuscular: neuromuscular.unwrap_or(default.neuromuscular),
        delay: choice.delay_s.map_or(Delay::Estimate, Delay::Given),
        delays_s: choice.delay_profile_s,
        drift: choice.drift.as_deref().map_or(Ok(default.drift), drift).map_err(|e| format!("drift: {e}"))?,
        skip_s: choice.skip_s.unwrap_or(default.skip_s),
        hold: choice.hold.unwrap_or(default.hold),
        filter: choice.filter,
        linear: choice.linear,
        select: choice
            .select
            .as_deref()
            .map_or(Ok(default.select), select)
            .map_err(|e| format!("select: {e}"))?,
        reduce_until: default.reduce_until.filter(|_| choice.reduce),
        seed: choice.seed,
        bicycle: default.bicycle,
    })
}
