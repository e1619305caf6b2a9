//! Evaluates laws: the area of the basin of each law in every trial.

use super::Scenarios;
use crate::basin::{Basin, Search};
use crate::study::trial::{Trial, TrialError, basins};
use control::Law;

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
