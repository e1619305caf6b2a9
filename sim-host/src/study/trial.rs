//! A trial: who rides what, how late the sensors are and what the motor may give. Laws are judged by the basins
//! they have in it.

use crate::basin::{Basin, Column, Search, border};
use crate::bicycle::{Geometry, catalogue};
use crate::ride::{Assist, Conditions, FallCriterion};
use crate::rider::{Fit, Outside, Rider, catalogue as riders};
use control::{Config, Law, Limits};
use rayon::prelude::*;

/// Who rides what under which limits.
#[derive(Clone, Debug)]
pub struct Trial {
    /// In a few words.
    pub label: String,
    /// The bicycle.
    pub bicycle: Geometry,
    /// Who rides; `None` for a rigid rider, hands off.
    pub rider: Option<Rider>,
    /// How late the sensors are \[control periods of 1 ms\].
    pub sensor_delay_ms: u16,
    /// What the motor may be asked for.
    pub limits: Limits,
    /// When a ride counts as fallen.
    pub fall: FallCriterion,
}

impl Trial {
    /// A trial of a shipped bicycle and rider, by mean gains and the table's own delay, or another \[s\]; falls are those by default.
    ///
    /// # Errors
    /// When there is no such bicycle or rider.
    pub fn new(
        bicycle: &str,
        rider: Option<&str>,
        delay_s: Option<f64>,
        sensor_delay_ms: u16,
        limits: Limits,
    ) -> Result<Self, String> {
        let parameters = catalogue::load(bicycle).map_err(|e| e.to_string())?.parameters;
        let table = rider.map(riders::load).transpose().map_err(|e| e.to_string())?;
        let rider_of = |t: &crate::rider::RiderTable| t.rider(Fit::default(), Outside::default(), delay_s);
        let ridden = table.as_ref().map(rider_of).transpose().map_err(|e| e.to_string())?;
        let late = delay_s.map_or(String::new(), |s| format!(" with {} ms", (s * 1e6).round() / 1e3));
        let label =
            format!("{bicycle}, {}{late}, sensors {sensor_delay_ms} ms late", rider.unwrap_or("no rider"));
        let (bicycle, fall) = (Geometry::new(&parameters), FallCriterion::default());
        Ok(Self { label, bicycle, rider: ridden, sensor_delay_ms, limits, fall })
    }

    /// The conditions of its rides under a law, steered by the flashed code.
    ///
    /// # Errors
    /// When the law or the limits are out of range, or the conditions can't be ridden.
    pub fn conditions(&self, law: &Law) -> Result<Conditions, String> {
        let assist = match law {
            Law::None => Assist::None,
            _ => {
                let config = Config { limits: self.limits, ..Config::thesis(law.clone()) };
                Assist::Firmware(Box::new(config.plan().map_err(|e| e.to_string())?))
            }
        };
        let conditions = Conditions {
            rider: self.rider.clone(),
            sensor_delay_ticks: self.sensor_delay_ms,
            fall: self.fall,
            ..Conditions::thesis(self.bicycle, assist)
        };
        conditions.check().map_err(|e| e.to_string())?;
        Ok(conditions)
    }
}

/// The basin of every trial and law asked for without what lies beyond, all columns side by side; `advanced` is called
/// for each. `None` if `stop` said so on the way.
///
/// # Errors
/// As of [`Trial::conditions`], or when the search fails its check.
pub fn basins(
    asked: &[(&Trial, &Law)],
    search: &Search,
    advanced: &(dyn Fn() + Sync),
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Vec<Basin>>, String> {
    search.check().map_err(|e| e.to_string())?;
    let conditions: Vec<Conditions> =
        asked.iter().map(|(trial, law)| trial.conditions(law)).collect::<Result<_, _>>()?;
    let speeds = search.speeds.len();
    let columns: Option<Vec<Column>> = (0..asked.len() * speeds)
        .into_par_iter()
        .map(|i| {
            if stop() {
                return None;
            }
            let column = border(&conditions[i / speeds], search, search.speeds[i % speeds]);
            advanced();
            Some(column)
        })
        .collect();
    Ok(columns.map(|all| all.chunks(speeds).map(|columns| Basin { columns: columns.to_vec() }).collect()))
}

/// The least area of a law over trials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Least {
    /// The area \[rad m/s^2\].
    pub area: f64,
    /// Which trial's.
    pub of: usize,
    /// Whether it is a lower bound, as nothing fell up to the largest rate tried at some speed.
    pub capped: bool,
}

/// The least area of a law over `trials`, and whose it is. The trial `first` is ridden whole, the others only as far
/// as they could still be less: the answer is that of [`basins`]. `None` if `stop` said so on the way.
///
/// # Errors
/// As of [`basins`].
pub fn least_area(
    trials: &[Trial],
    law: &Law,
    search: &Search,
    first: usize,
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Least>, String> {
    let Some(trial) = trials.get(first) else { return Err("there is no such trial".into()) };
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
            for &speed in &search.speeds {
                if stop() {
                    return None;
                }
                basin.columns.push(border(&conditions[of], search, speed));
                // No strip is negative.
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
