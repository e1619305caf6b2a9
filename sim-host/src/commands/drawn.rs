//! Drawn bicycles or riders of a basin: from the scenario to their conditions, and their part of the result.

use super::linear_loop::feedback;
use super::{Hooks, Setup};
use crate::basin::{Drawn, Search, drawn, drawn_bicycles, drawn_riders};
use crate::eigen::{Model, unstable};
use crate::report::document::{BasinDocument, RiderDrawsEntry, UncertainEntry};
use crate::ride::Conditions;
use crate::rider::Drawing;
use crate::scenario::ScenarioError;

/// Requested draws.
#[derive(Clone, Debug)]
pub struct Draws {
    /// The conditions of each.
    conditions: Vec<Conditions>,
    seed: u64,
    /// What riders are drawn from; none for bicycles.
    riders: Option<Drawing>,
}

/// Basins of draws.
#[derive(Clone, Debug)]
pub struct DrawnBasins {
    /// The basins.
    pub of: Drawn,
    /// Requested draws.
    pub count: usize,
    /// For riders: what they are drawn from, and their linear stability.
    pub riders: Option<DrawnRiders>,
}

/// What is known of drawn riders besides their basins.
#[derive(Clone, Debug)]
pub struct DrawnRiders {
    /// What they are drawn from.
    pub from: Drawing,
    /// Per speed, the number of linearly unstable draws.
    pub unstable: Vec<usize>,
}

impl Draws {
    /// The draws that a scenario requests.
    ///
    /// # Errors
    /// Nothing is known of the uncertainties, or no draw is possible.
    pub fn new(setup: &Setup) -> Result<Option<Self>, ScenarioError> {
        let (scenario, conditions) = (&setup.scenario, &setup.conditions);
        let (drawn, riders) = match (scenario.uncertain, scenario.rider_draws, &setup.rider) {
            (Some(count), ..) => {
                let measured = setup.measured.as_ref().ok_or_else(|| {
                    let name = &setup.config.bicycle.name;
                    let reason = format!(
                        "bicycle {name} has no uncertainties; a value with one is written \"1.12+/-0.02\""
                    );
                    ScenarioError::value("uncertain", reason)
                })?;
                (drawn_bicycles(conditions, measured, count)?, None)
            }
            (None, Some(count), Some(rider)) => {
                let from = rider.table.drawing().map_err(|e| ScenarioError::value("rider_draws", e))?;
                let fit = (rider.fit, rider.rider.schedule.outside());
                (drawn_riders(conditions, (&rider.table, from), fit, count)?, Some(from))
            }
            _ => return Ok(None),
        };
        Ok(Some(Self { conditions: drawn, seed: conditions.plant.seed, riders }))
    }

    /// Number of draws.
    pub fn count(&self) -> usize {
        self.conditions.len()
    }

    /// Computes their basins; see [`drawn`].
    pub fn basins(&self, setup: &Setup, search: &Search, hooks: Hooks) -> DrawnBasins {
        let of = drawn(&self.conditions, self.seed, search, hooks.finished, hooks.stop);
        let model = |i: &usize| {
            let Conditions { assist, rider, .. } = &self.conditions[*i];
            Model::new(&setup.parameters, feedback(assist), rider.clone())
        };
        let riders = self.riders.map(|from| {
            let models: Vec<Model> = of.numbers.iter().map(model).collect();
            DrawnRiders { from, unstable: unstable(&models, &search.speeds) }
        });
        DrawnBasins { of, count: self.count(), riders }
    }
}

impl DrawnBasins {
    /// Adds the draws to a document.
    pub fn add_to(&self, document: BasinDocument) -> BasinDocument {
        let basins = UncertainEntry::new(&self.of);
        match &self.riders {
            None => BasinDocument { uncertain: Some(basins), ..document },
            Some(DrawnRiders { from, unstable }) => {
                let entry = RiderDrawsEntry { drawn_from: *from, unstable: unstable.clone(), basins };
                BasinDocument { rider_draws: Some(entry), ..document }
            }
        }
    }
}
