//! Drawn bicycles or riders of `sim-host basin`: from the scenario to their conditions, and their part of the result.

use super::Failure;
use super::conditions::Setup;
use crate::basin::{Drawn, Search, drawn, drawn_bicycles, drawn_riders};
use crate::eigen::{Feedback, Model, unstable};
use crate::report::document::{BasinDocument, RiderDrawsEntry, UncertainEntry};
use crate::ride::{Assist, Conditions};
use crate::rider::Drawing;
use crate::scenario::Scenario;
use control::Law;
use std::fmt::Write;

/// Requested draws.
pub(super) struct Draws {
    /// The conditions of each.
    conditions: Vec<Conditions>,
    seed: u64,
    /// What riders are drawn from; none for bicycles.
    riders: Option<Drawing>,
}

/// Basins of draws.
pub(super) struct DrawnBasins {
    pub(super) of: Drawn,
    /// Requested draws.
    pub(super) count: usize,
    riders: Option<DrawnRiders>,
}

struct DrawnRiders {
    from: Drawing,
    /// Per speed, the number of linearly unstable draws.
    unstable: Vec<usize>,
}

/// The draws that a scenario requests.
pub(super) fn draws(scenario: &Scenario, setup: &Setup) -> Result<Option<Draws>, Failure> {
    let conditions = &setup.conditions;
    let (conditions, riders) = match (scenario.uncertain, scenario.rider_draws, &setup.rider) {
        (Some(count), ..) => {
            let measured = setup.measured.as_ref().ok_or_else(|| {
                format!(
                    "--uncertain: bicycle {} has no uncertainties; a value with one is written \"1.12+/-0.02\"",
                    setup.config.bicycle.name
                )
            })?;
            (drawn_bicycles(conditions, measured, count)?, None)
        }
        (None, Some(count), Some(rider)) => {
            let from = rider.table.drawing().map_err(|e| format!("--rider-draws: {e}"))?;
            let fit = (rider.fit, rider.rider.schedule.outside());
            (drawn_riders(conditions, (&rider.table, from), fit, count)?, Some(from))
        }
        _ => return Ok(None),
    };
    Ok(Some(Draws { conditions, seed: setup.conditions.plant.seed, riders }))
}

impl Draws {
    /// Number of draws.
    pub(super) fn count(&self) -> usize {
        self.conditions.len()
    }

    /// Computes their basins; see [`drawn`].
    pub(super) fn basins(
        &self,
        setup: &Setup,
        search: &Search,
        finished: impl Fn() + Sync,
        stop: impl Fn() -> bool + Sync,
    ) -> DrawnBasins {
        let of = drawn(&self.conditions, self.seed, search, finished, stop);
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

/// The feedback of an assist for small motions, without sensor delay.
fn feedback(assist: &Assist) -> Feedback {
    match assist {
        Assist::Firmware(plan) => Feedback::new(plan.config().law.clone(), plan.config().capsize),
        Assist::Ideal(ideal) => Feedback::new(ideal.law.clone(), Default::default()),
        Assist::None | Assist::Own(_) => Feedback::new(Law::None, Default::default()),
    }
}

impl DrawnBasins {
    /// What was drawn.
    fn noun(&self) -> &'static str {
        if self.riders.is_some() { "riders" } else { "bicycles" }
    }

    /// Label of the band in figures.
    pub(super) fn label(&self) -> String {
        format!("5 % to 95 % of {} drawn {}", self.of.basins.len(), self.noun())
    }

    /// Adds the draws to a document.
    pub(super) fn add_to(&self, document: BasinDocument) -> BasinDocument {
        let basins = UncertainEntry::new(&self.of);
        match &self.riders {
            None => BasinDocument { uncertain: Some(basins), ..document },
            Some(DrawnRiders { from, unstable }) => {
                let entry = RiderDrawsEntry { drawn_from: *from, unstable: unstable.clone(), basins };
                BasinDocument { rider_draws: Some(entry), ..document }
            }
        }
    }

    /// Text: what was drawn, and quantiles of area and mean height.
    pub(super) fn summary(&self, speeds: &[f64]) -> String {
        let entry = UncertainEntry::new(&self.of);
        let at_least = if entry.capped > 0 { ", at least" } else { "" };
        let mut text = String::new();
        let mut line = |name, [low, middle, high]: [f64; 3], unit| {
            let (n, noun) = (entry.draws, self.noun());
            let _ = writeln!(
                text,
                "{name} of {n} drawn {noun}: 5 % {low:.3}, median {middle:.3}, 95 % {high:.3} {unit}{at_least}"
            );
        };
        if speeds.len() > 1 {
            line("area", entry.area, "rad m/s^2");
        }
        line("mean height", entry.mean_height, "rad/s");
        let Some(riders) = &self.riders else { return text };
        let from = match riders.from {
            Drawing::Posterior => "each set of gains from the normal distribution of its covariance",
            Drawing::Bootstrap => "the sets of each group with replacement (bootstrap)",
        };
        let _ = writeln!(text, "drawn: {from}");
        let most = riders.unstable.iter().zip(speeds).max_by_key(|(n, _)| **n);
        let _ = match most.filter(|(n, _)| **n > 0) {
            None => writeln!(text, "no drawn rider is linearly unstable at any of the speeds"),
            Some((most, _)) => {
                let some = riders.unstable.iter().filter(|n| **n > 0).count();
                let at = riders.unstable.iter().position(|n| n == most).map_or(0.0, |i| speeds[i]);
                writeln!(
                    text,
                    "linearly unstable drawn riders (part of all quantiles): at {some} of {} speeds; most, {most} of {}, \
                     at {at} m/s",
                    speeds.len(),
                    entry.draws
                )
            }
        };
        text
    }
}
