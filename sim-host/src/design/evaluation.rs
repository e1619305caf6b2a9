//! Evaluates laws: the area of the basin of each law in every trial.

use super::{DesignError, Scenarios};
use crate::basin::{Basin, Search};
use crate::report::resolved::ResolvedConfig;
use crate::scenario::Speeds;
use crate::study::trial::{Trial, TrialError, basins};
use crate::sweep::document::SweepDocument;
use crate::sweep::{self, Axis, Cell, Folder, Grid, Plan, Progress, SweepError, Unit};
use control::Law;
use serde_json::Value;
use std::path::Path;

/// Areas of the laws in all trials.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// For each trial, training trials first, the area of each law \[rad m/s^2\].
    pub areas: Vec<Vec<f64>>,
    /// Whether these are lower bounds, as no ride fell up to the largest rate tried at some speed.
    pub capped: Vec<Vec<bool>>,
}

/// Laws with which a design is compared, and their names on the command line.
pub fn competitors() -> Vec<(String, Law)> {
    [
        Law::None,
        Law::H { cut: true },
        Law::F,
        Law::G,
        Law::Cl2 { k: 2.0 },
        Law::Cl2 { k: 4.0 },
        Law::BalanceAssist { kappa: 5.2 },
        Law::BalanceAssist { kappa: 10.0 },
    ]
    .map(|law| (law.to_string(), law))
    .to_vec()
}

/// Evaluates `laws` like [`evaluate`], as a sweep over trials and laws in a folder: continued after an interruption, and
/// shared by processes that have the same laws.
///
/// # Errors
/// A trial can't be simulated, or the folder can't be used.
pub fn evaluate_in(
    folder: &Path,
    scenarios: &Scenarios,
    laws: &[(String, Law)],
    search: &Search,
    progress: &Progress,
) -> Result<Option<Evaluation>, DesignError> {
    let trials: Vec<&Trial> = scenarios.training.iter().chain(&scenarios.held_out).collect();
    let mut resolved = Vec::new();
    for trial in &trials {
        for (_, law) in laws {
            resolved.push(trial.resolve(law)?);
        }
    }
    let configs = resolved.iter().map(|cell| serde_json::to_value(ResolvedConfig::new(cell)));
    let configs: Vec<Value> = configs.collect::<Result<_, _>>().map_err(SweepError::from)?;
    let axes = vec![
        Axis { key: "trial".into(), values: trials.iter().map(|trial| trial.label.clone()).collect() },
        Axis { key: "law".into(), values: laws.iter().map(|(name, _)| name.clone()).collect() },
    ];
    // The laws by their content, as the name of the designed one is always the same.
    let options = laws.iter().map(|(name, law)| format!("{name}: {law:?}")).collect();
    let plan = Plan::new(options, axes, search, &configs);
    let mut cells = Vec::new();
    for (id, (config, cell)) in plan.cells.iter().zip(configs.into_iter().zip(resolved)) {
        let mut scenario = cell.scenario;
        scenario.search.speeds = Some(Speeds::List(search.speeds.clone()));
        let scenario = serde_json::to_value(&scenario).map_err(SweepError::from)?;
        cells.push(Cell { id: id.clone(), config, scenario, conditions: cell.conditions });
    }
    let folder = Folder::open(folder, &plan)?;
    let done = sweep::run(&cells.iter().collect::<Vec<_>>(), search, &folder, progress)?;
    if done.cells < cells.len() {
        return Ok(None);
    }
    let grid = Grid::gather(&plan, std::slice::from_ref(&folder))?;
    sweep::write(&grid, &SweepDocument::new(&grid), &folder)?;
    let units: Vec<&Unit> = grid.units.iter().flatten().collect();
    // None only at a single speed, where `Basin::area` is 0 as well.
    let area = |unit: &&Unit| grid.area(unit).unwrap_or_default();
    Ok(Some(Evaluation {
        areas: units.chunks(laws.len()).map(|of| of.iter().map(area).collect()).collect(),
        capped: units.chunks(laws.len()).map(|of| of.iter().map(|unit| unit.capped()).collect()).collect(),
    }))
}

/// Evaluates `laws`; `None` if stopped by `stop`.
///
/// # Errors
/// A trial can't be simulated.
pub fn evaluate(
    scenarios: &Scenarios,
    laws: &[(String, Law)],
    search: &Search,
    advanced: &(dyn Fn() + Sync),
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Evaluation>, TrialError> {
    let trials = scenarios.training.iter().chain(&scenarios.held_out);
    let cases: Vec<(&Trial, &Law)> =
        trials.flat_map(|trial| laws.iter().map(move |(_, law)| (trial, law))).collect();
    let basins = basins(&cases, search, advanced, stop)?;
    Ok(basins.map(|all| {
        let by_trial = || all.chunks(laws.len());
        Evaluation {
            areas: by_trial().map(|of_laws| of_laws.iter().map(Basin::area).collect()).collect(),
            capped: by_trial().map(|of_laws| of_laws.iter().map(Basin::capped).collect()).collect(),
        }
    }))
}
