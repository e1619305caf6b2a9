//! `identify`.

use crate::error::{of_choice, of_scenario};
use crate::scenario::{chosen, json, parsed};
use crate::work::{Options, run};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use serde::Deserialize;
use sim_host::bicycle::ForcePoint;
use sim_host::commands::identify::{Delay, IdentifyChoice, ready};
use sim_host::commands::identify_text::{ChoiceTextError, drift, select};
use sim_host::identify::{Hold, Signal, Stage, symbols};
use sim_host::range::{RangeError, within_key};
use sim_host::recording::ReadOptions;
use sim_host::replay::Map;
use sim_host::rider::{MAX_DELAY_S, Neuromuscular};
use sim_host::rider_record::RecordError;
use std::error::Error;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

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
    let choice = chosen_of(chosen(py, choice)?, IdentifyChoice::new(bicycle));
    let choice = choice.map_err(|(key, message, range)| of_choice(py, &message, Some(key), range))?;
    let options = Options { parts: STAGES, threads, progress, law: None };
    let (found, interrupted) = run(py, &options, |hooks| {
        let begins = |_: Stage| (hooks.finished)();
        ready(&choice, &file)?.identify(&choice.bicycle, &begins, hooks.stop)
    })?;
    if interrupted {
        return Err(PyKeyboardInterrupt::new_err("the identification was interrupted"));
    }
    let found = found.map_err(|error| of_record(py, &file, &*error))?;
    Ok((json(&found.document), found.rider.to_toml()))
}

/// A choice that can't be used: its key, message and range.
type Wrong = (&'static str, String, Option<(f64, f64)>);

/// The error of the value of `key`.
fn wrong<'a>(key: &'static str) -> impl Fn(Box<dyn Error + 'a>) -> Wrong {
    move |error| (key, format!("{key}: {error}"), None)
}

/// A number outside its range.
fn outside(error: RangeError) -> Wrong {
    (error.key.unwrap_or_default(), error.to_string(), Some(error.bounds()))
}

/// A number of the neuromuscular dynamics outside its range, a frequency in Hz as it was given.
fn in_hz(error: RangeError) -> RangeError {
    let key = Some("neuromuscular");
    match error.name.strip_suffix("(rad/s)") {
        Some(start) => {
            let [value, min, max] = [error.value, error.min, error.max].map(|rad_s| rad_s / TAU);
            RangeError { name: format!("{start}(Hz)"), key, value, min, max }
        }
        None => RangeError { key, ..error },
    }
}

/// A text that is no choice of `key`.
fn unread(key: &'static str) -> impl Fn(ChoiceTextError) -> Wrong {
    move |error| (key, format!("{key}: {error}"), error.range())
}

/// The choices as the library has them.
fn chosen_of(choice: Choice, default: IdentifyChoice) -> Result<IdentifyChoice, Wrong> {
    let gain = |name: &String| {
        let place = symbols().iter().position(|symbol| symbol == name);
        let unknown = || wrong("gains")(format!("`{name}` is none of {}", symbols().join(", ")).into());
        place.ok_or_else(unknown)
    };
    if let Some(delay_s) = choice.delay_s {
        within_key("delay_s", "delay_s", delay_s, 0.0, LONGEST_S).map_err(outside)?;
    }
    for delay_s in &choice.delay_profile_s {
        within_key("delay_profile_s", "delay_profile_s", *delay_s, 0.0, MAX_DELAY_S).map_err(outside)?;
    }
    if let Some(skip_s) = choice.skip_s {
        within_key("skip_s", "skip_s", skip_s, 0.0, 3600.0).map_err(outside)?;
    }
    if let Some((ahead_m, height_m)) = choice.force_at_m {
        within_key("force_at_m", "force_at_m: ahead", ahead_m, -3.0, 5.0).map_err(outside)?;
        within_key("force_at_m", "force_at_m: height", height_m, 0.0, 5.0).map_err(outside)?;
    }
    let neuromuscular = choice.neuromuscular.map(|(hz, zeta)| Neuromuscular { omega_rad_s: hz * TAU, zeta });
    if let Some(muscles) = &neuromuscular {
        muscles.check().map_err(|e| outside(in_hz(e)))?;
    }
    let map = choice.map.as_deref().map(Map::load).transpose();
    Ok(IdentifyChoice {
        map: map.map_err(|e| wrong("map")(e.into()))?,
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
        drift: choice.drift.as_deref().map_or(Ok(default.drift), drift).map_err(unread("drift"))?,
        skip_s: choice.skip_s.unwrap_or(default.skip_s),
        hold: choice.hold.unwrap_or(default.hold),
        filter: choice.filter,
        linear: choice.linear,
        select: choice.select.as_deref().map_or(Ok(default.select), select).map_err(unread("select"))?,
        reduce_until: default.reduce_until.filter(|_| choice.reduce),
        seed: choice.seed,
        bicycle: default.bicycle,
    })
}

/// An error of a record.
fn of_record(py: Python<'_>, file: &Path, error: &(dyn Error + Send + Sync + 'static)) -> PyErr {
    let (key, range) = match error.downcast_ref() {
        Some(RecordError::Range(error)) => (error.key, Some(error.bounds())),
        Some(RecordError::NoSpeed) => (Some("speed_m_s"), None),
        _ => (None, None),
    };
    of_choice(py, &format!("{}: {error}", file.display()), key, range)
}
