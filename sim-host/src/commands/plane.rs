//! The basin at one speed over steer rate and roll rate together.

use super::{CommandError, Hooks, Setup};
use crate::basin::{Plane, PlaneSearch, plane as search_plane};
use crate::report::plane::PlaneDocument;
use crate::scenario::{Scenario, ScenarioError, SpeedsError};
use std::time::Instant;

/// A complete or partial basin over two rates.
#[derive(Clone, Debug)]
pub struct PlaneFound {
    /// The basin.
    pub plane: Plane,
    /// Computing time \[s\].
    pub seconds: f64,
    search: PlaneSearch,
}

/// The search of a scenario.
///
/// # Errors
/// The scenario has none.
pub fn search(scenario: &Scenario) -> Result<PlaneSearch, ScenarioError> {
    scenario.plane.ok_or_else(|| ScenarioError::value("plane.speed", SpeedsError::Missing { least_m_s: 0.0 }))
}

/// Rejects conditions that the mirror image of a ride does not have.
///
/// # Errors
/// There are such.
pub fn check_mirrored(setup: &Setup) -> Result<(), CommandError> {
    if setup.conditions.plant.mirrors() { Ok(()) } else { Err(CommandError::OneSided) }
}

/// Searches the basin of a scenario on all cores of the current rayon pool.
///
/// # Errors
/// The scenario has no such search, or its conditions distinguish left from right.
pub fn plane(setup: &Setup, hooks: Hooks) -> Result<PlaneFound, CommandError> {
    let search = search(&setup.scenario)?;
    check_mirrored(setup)?;
    let begin = Instant::now();
    let plane = search_plane(&setup.conditions, &search, |_| (hooks.finished)(), hooks.stop)?;
    Ok(PlaneFound { plane, seconds: begin.elapsed().as_secs_f64(), search })
}

impl PlaneFound {
    /// The document.
    pub fn document(&self, setup: &Setup) -> PlaneDocument {
        let parts = (setup.config.clone(), self.search, setup.scenario.clone());
        PlaneDocument::new(parts, &self.plane, self.seconds)
    }
}
