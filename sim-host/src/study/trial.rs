//! A trial: bicycle, rider, sensor delay and motor limits. Laws are compared by their basins in a trial.

use crate::basin::{Basin, Column, Search, SearchError, borders, together};
use crate::parameters::departing;
use crate::ride::Conditions;
use crate::scenario::{Resolved, RiderChoice, Scenario, ScenarioError, law};
use control::{Config, Law, Limits};
use rayon::prelude::*;

/// Conditions under which laws are compared.
#[derive(Clone, Debug)]
pub struct Trial {
    /// A short label.
    pub label: String,
    /// The conditions; the law is that of each comparison.
    pub scenario: Scenario,
}

/// Trials that cannot be simulated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TrialError {
    /// Conditions that cannot be ridden.
    #[error("{label}: {error}")]
    Conditions {
        /// The trial's label.
        label: String,
        /// The error.
        error: Box<ScenarioError>,
    },
    /// A value of the search is outside its range.
    #[error(transparent)]
    Search(#[from] SearchError),
    /// An index of no trial.
    #[error("there is no such trial")]
    Index,
}

impl Trial {
    /// A trial of a built-in bicycle and rider, with mean gains and the table's own delay or the given one \[s\];
    /// the default fall criterion. Of the firmware, only these limits of the motor torque are on.
    pub fn new(
        bicycle: &str,
        rider: Option<&str>,
        delay_s: Option<f64>,
        sensor_delay_ms: u16,
        limits: Limits,
    ) -> Self {
        let late = delay_s.map_or(String::new(), |s| format!(" with {} ms", (s * 1e6).round() / 1e3));
        let label =
            format!("{bicycle}, {}{late}, sensors {sensor_delay_ms} ms late", rider.unwrap_or("no rider"));
        let published = Config::thesis(Law::None);
        let limited = departing(&Config { limits, ..published.clone() }, &published);
        let scenario = Scenario {
            bicycle: bicycle.into(),
            rider: RiderChoice { table: rider.map(Into::into), delay_s, ..RiderChoice::default() },
            sensor_delay_s: f64::from(sensor_delay_ms) * 1e-3,
            parameters: limited.into_iter().map(|(key, value)| (key, value.as_str().into())).collect(),
            ..Scenario::default()
        };
        Self { label, scenario }
    }

    /// The conditions of a ride under a law, executed by the firmware's control code.
    ///
    /// # Errors
    /// The bicycle or rider does not exist, law or limits are out of range, or invalid conditions.
    pub fn conditions(&self, law: &Law) -> Result<Conditions, TrialError> {
        Ok(self.resolve(law)?.conditions)
    }

    /// The trial with a law, as a scenario with all that it names.
    ///
    /// # Errors
    /// See [`Trial::conditions`].
    pub fn resolve(&self, law: &Law) -> Result<Resolved, TrialError> {
        let law = Some(law::content("table", law));
        let resolved = Scenario { law, ..self.scenario.clone() }.resolve();
        resolved.map_err(|error| TrialError::Conditions { label: self.label.clone(), error: Box::new(error) })
    }
}

/// The basins of the given trials and laws, without islands, all columns in parallel; `advanced` is called for each
/// column. `None` if `stop` interrupted the computation.
///
/// # Errors
/// As for [`Trial::conditions`], or an invalid search.
pub fn basins(
    requested: &[(&Trial, &Law)],
    search: &Search,
    advanced: &(dyn Fn() + Sync),
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Vec<Basin>>, TrialError> {
    search.check()?;
    let conditions: Vec<Conditions> =
        requested.iter().map(|(trial, law)| trial.conditions(law)).collect::<Result<_, _>>()?;
    let speeds = search.speeds.len();
    let groups: Vec<(usize, &[f64])> = conditions
        .iter()
        .enumerate()
        .flat_map(|(of, conditions)| {
            let size = together(conditions, search, requested.len() * speeds);
            search.speeds.chunks(size).map(move |speeds| (of, speeds))
        })
        .collect();
    let columns: Option<Vec<Vec<Column>>> = groups
        .into_par_iter()
        .map(|(of, speeds)| {
            if stop() {
                return None;
            }
            let columns = borders(&conditions[of], search, speeds);
            speeds.iter().for_each(|_| advanced());
            Some(columns)
        })
        .collect();
    let basins = |all: Vec<Column>| all.chunks(speeds).map(|c| Basin { columns: c.to_vec() }).collect();
    Ok(columns.map(|groups| basins(groups.into_iter().flatten().collect())))
}

/// The smallest area of a law over several trials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Least {
    /// The area \[rad m/s^2\].
    pub area: f64,
    /// Index of its trial.
    pub of: usize,
    /// Whether it is a lower bound because nothing fell up to the largest rate tried at some speed.
    pub capped: bool,
}

/// The smallest area of a law over `trials`, and its trial. The trial `first` is computed completely, the others only
/// while their area can still be smaller; the result equals that of [`basins`]. `None` if `stop` interrupted the
/// computation.
///
/// # Errors
/// See [`basins`].
pub fn least_area(
    trials: &[Trial],
    law: &Law,
    search: &Search,
    first: usize,
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Least>, TrialError> {
    let Some(trial) = trials.get(first) else { return Err(TrialError::Index) };
    let Some(bound) = basins(&[(trial, law)], search, &|| {}, stop)? else { return Ok(None) };
    let bound = &bound[0];
    let conditions: Vec<Conditions> =
        trials.iter().map(|trial| trial.conditions(law)).collect::<Result<_, _>>()?;
    let found: Option<Vec<Least>> = (0..trials.len())
        .into_par_iter()
        .map(|of| {
            if of == first {
                return Some(Least { area: bound.area(), of, capped: bound.capped() });
            }
            let mut basin = Basin { columns: Vec::new() };
            // In halves: less is computed in vain, and still many at once.
            let half = search.speeds.len().div_ceil(2);
            for speeds in search.speeds.chunks(half.min(together(&conditions[of], search, usize::MAX)).max(1))
            {
                if stop() {
                    return None;
                }
                basin.columns.extend(borders(&conditions[of], search, speeds));
                // Every strip of the area is at least zero.
                if basin.area() > bound.area() {
                    break;
                }
            }
            Some(Least { area: basin.area(), of, capped: basin.capped() })
        })
        .collect();
    let start = Least { area: bound.area(), of: first, capped: bound.capped() };
    let least = |all: Vec<Least>| all.into_iter().fold(start, |a, b| if b.area < a.area { b } else { a });
    Ok(found.map(least))
}
