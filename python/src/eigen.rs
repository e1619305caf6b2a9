//! `eigen`.

use crate::error::{of_renamed, of_scenario};
use crate::scenario::{chosen, json, parsed};
use crate::work::{Options, run};
use control::Capsize;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use serde::Deserialize;
use sim_host::commands::eigen::{EigenTask, eigen_until};
use sim_host::eigen::LinearActuator;
use sim_host::scenario::{Scenario, law};

/// Quantities of the actuator whose argument has another name.
const NAMES: [(&str, &str); 4] = [
    ("actuator.delay_s", "actuator_delay_s"),
    ("actuator.time_constant_s", "actuator_lag_s"),
    ("actuator.viscous_nm_s_rad", "steer_friction_nm_s_rad"),
    ("actuator.inertia_kg_m2", "steer_inertia_kg_m2"),
];

/// Choices of the analysis beside the scenario.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Choice {
    speeds: Vec<f64>,
    roots: Option<usize>,
    capsize: Option<(f32, f32)>,
    actuator_delay_s: f64,
    actuator_lag_s: f64,
    steer_friction_nm_s_rad: f64,
    steer_inertia_kg_m2: f64,
}

impl Default for Choice {
    fn default() -> Self {
        Self {
            speeds: (0..=100).map(|i| f64::from(i) / 10.0).collect(),
            roots: None,
            capsize: None,
            actuator_delay_s: 0.0,
            actuator_lag_s: 0.0,
            steer_friction_nm_s_rad: 0.0,
            steer_inertia_kg_m2: 0.0,
        }
    }
}

/// Eigenvalues of a scenario's bicycle, rider and law over speed: the document as JSON.
#[pyfunction]
pub(crate) fn eigen(py: Python<'_>, scenario: &str, choice: &str) -> PyResult<String> {
    let scenario = parsed(py, scenario)?;
    let choice: Choice = chosen(py, choice)?;
    let task = task(py, &scenario, choice)?;
    let options = Options { parts: 1, threads: None, progress: None, law: None };
    let (found, interrupted) = run(py, &options, |hooks| eigen_until(&task, hooks.stop))?;
    match found.map_err(|error| of_renamed(py, &error, &NAMES))? {
        Some(found) if !interrupted => Ok(json(&found.document)),
        _ => Err(PyKeyboardInterrupt::new_err("the analysis was interrupted")),
    }
}

fn task(py: Python<'_>, scenario: &Scenario, choice: Choice) -> PyResult<EigenTask> {
    let wrong = |error| of_scenario(py, &error);
    let none = "none".into();
    let law = law::resolve(scenario.law.as_ref().unwrap_or(&none)).map_err(|error| wrong(error.into()))?;
    Ok(EigenTask {
        bicycle: scenario.bicycle().map_err(wrong)?,
        rider: scenario.rider.load().map_err(wrong)?,
        law,
        capsize: choice.capsize.map(|(k_c, v_max_m_s)| Capsize { k_c, v_max_m_s }),
        actuator: LinearActuator {
            delay_s: choice.actuator_delay_s,
            time_constant_s: choice.actuator_lag_s,
            viscous_nm_s_rad: choice.steer_friction_nm_s_rad,
            inertia_kg_m2: choice.steer_inertia_kg_m2,
            ..LinearActuator::default()
        },
        speeds: choice.speeds,
        roots: choice.roots,
    })
}
