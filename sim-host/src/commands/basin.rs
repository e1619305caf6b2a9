//! The basin of attraction over forward speed.

use super::drawn::{DrawnBasins, Draws};
use super::{CommandError, Hooks, Setup};
use crate::basin::{Basin, Column, Refined, Rounds, Search, SearchError, basin_in_rounds};
use crate::report::document::BasinDocument;
use crate::report::resolved::ResolvedSearch;
use crate::scenario::ScenarioError;
use std::time::Instant;

/// A basin to search.
#[derive(Clone, Debug)]
pub struct BasinTask {
    /// The scenario.
    pub setup: Setup,
    /// The search.
    pub search: Search,
    draws: Option<Draws>,
}

/// A complete or partial basin.
#[derive(Clone, Debug)]
pub struct Searched {
    /// The search, with the speeds that were added.
    pub search: Search,
    /// The basin.
    pub basin: Basin,
    /// Results for draws, if requested.
    pub drawn: Option<DrawnBasins>,
    /// Computing time of the basin \[s\].
    pub seconds: f64,
}

impl BasinTask {
    /// The basin of a scenario.
    ///
    /// # Errors
    /// The search or the requested draws are wrong.
    pub fn new(setup: Setup) -> Result<Self, ScenarioError> {
        let draws = Draws::new(&setup)?;
        let search = setup.scenario.search.resolve(setup.rider.is_some())?;
        Ok(Self { setup, search, draws })
    }

    /// Number of columns, without those that adaptive speeds add.
    pub fn columns(&self) -> usize {
        (1 + self.draws.as_ref().map_or(0, Draws::count)) * self.search.speeds.len()
    }

    /// Searches the basin, and those of the draws, on all cores of the current rayon pool. `coarse_first` changes the order
    /// only; `column` gets every column of the basin itself.
    ///
    /// # Errors
    /// The search or the conditions fail their checks.
    pub fn run(
        &self,
        coarse_first: bool,
        column: impl Fn(&Column) + Sync,
        hooks: Hooks,
    ) -> Result<Searched, SearchError> {
        let Self { setup, search, draws } = self;
        let rounds = Rounds { coarse_first, adaptive: setup.scenario.search.adaptive_speeds };
        let basins = 1 + draws.as_ref().map_or(0, Draws::count);
        let finished = |done: &Column| {
            (hooks.finished)();
            column(done);
        };
        let begin = Instant::now();
        let added = |speeds: usize| (hooks.added)(basins * speeds);
        let found = basin_in_rounds(&setup.conditions, search, rounds, added, finished, hooks.stop)?;
        let seconds = begin.elapsed().as_secs_f64();
        let Refined { speeds, basin } = found;
        let search = Search { speeds, ..search.clone() };
        let drawn = draws.as_ref().map(|draws| draws.basins(setup, &search, hooks));
        Ok(Searched { search, basin, drawn, seconds })
    }
}

impl Searched {
    /// Whether every speed is searched.
    pub fn every_speed(&self) -> bool {
        self.basin.columns.len() == self.search.speeds.len()
    }

    /// Whether every speed is searched, and every draw.
    pub fn complete(&self) -> bool {
        let all = |drawn: &DrawnBasins| drawn.of.basins.len() == drawn.count;
        self.every_speed() && self.drawn.as_ref().is_none_or(all)
    }

    /// The results for draws, if any is finished.
    pub fn drawn(&self) -> Option<&DrawnBasins> {
        self.drawn.as_ref().filter(|drawn| !drawn.of.basins.is_empty())
    }

    /// The document.
    pub fn document(&self, setup: &Setup) -> BasinDocument {
        let adaptive_speeds = setup.scenario.search.adaptive_speeds;
        let search = ResolvedSearch { adaptive_speeds, ..ResolvedSearch::new(&self.search) };
        let parts = (setup.config.clone(), search, setup.scenario.clone());
        let found = BasinDocument::new(parts, &self.search.speeds, &self.basin, self.seconds);
        let document = BasinDocument { complete: self.complete(), ..found };
        match self.drawn() {
            Some(drawn) => drawn.add_to(document),
            None => document,
        }
    }
}

/// Searches the basin of a scenario.
///
/// # Errors
/// The search or the requested draws are wrong.
pub fn basin(setup: Setup, hooks: Hooks) -> Result<BasinDocument, CommandError> {
    let task = BasinTask::new(setup)?;
    Ok(task.run(false, |_| (), hooks)?.document(&task.setup))
}
