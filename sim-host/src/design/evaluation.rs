//! Judging laws beside each other: the basin of each in every trial.

use super::Scenarios;
use crate::basin::{Basin, Search};
use crate::study::trial::{Trial, basins};
use control::Law;

/// The areas of laws in an arena.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// Per trial, those to design with first, the area under each law \[rad m/s^2\].
    pub areas: Vec<Vec<f64>>,
    /// Whether they are lower bounds, as nothing fell up to the largest rate tried at some speed.
    pub capped: Vec<Vec<bool>>,
}

/// The laws that a design has to beat, by their names on the command line.
pub fn competitors() -> Vec<(String, Law)> {
    [
        ("none", Law::None),
        ("h-cut", Law::H { cut: true }),
        ("f", Law::F),
        ("g", Law::G),
        ("cl2:2", Law::Cl2 { k: 2.0 }),
        ("cl2:4", Law::Cl2 { k: 4.0 }),
        ("balance-assist:5.2", Law::BalanceAssist { kappa: 5.2 }),
        ("balance-assist:10", Law::BalanceAssist { kappa: 10.0 }),
    ]
    .map(|(name, law)| (name.to_owned(), law))
    .to_vec()
}

/// Judges `laws`; `None` if `stop` said so on the way.
///
/// # Errors
/// When a trial can't be ridden.
pub fn judge(
    arena: &Scenarios,
    laws: &[(String, Law)],
    search: &Search,
    advanced: &(dyn Fn() + Sync),
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Judged>, String> {
    let trials = arena.training.iter().chain(&arena.held_out);
    let asked: Vec<(&Trial, &Law)> =
        trials.flat_map(|trial| laws.iter().map(move |(_, law)| (trial, law))).collect();
    let basins = basins(&asked, search, advanced, stop)?;
    Ok(basins.map(|all| {
        let by_trial = || all.chunks(laws.len());
        Judged {
            areas: by_trial().map(|of_laws| of_laws.iter().map(Basin::area).collect()).collect(),
            capped: by_trial().map(|of_laws| of_laws.iter().map(Basin::capped).collect()).collect(),
        }
    }))
}
