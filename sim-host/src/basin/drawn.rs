//! Basins of bicycles drawn from the measured uncertainties of a bicycle.

use super::{Basin, Column, Search, SearchError, border};
use crate::bicycle::Geometry;
use crate::bicycle::uncertain::Measured;
use crate::ride::Conditions;
use rayon::prelude::*;

/// Probabilities of the reported quantiles.
pub const QUANTILES: [f64; 3] = [0.05, 0.5, 0.95];

/// Basins of drawn bicycles; only those computed at every speed.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// Seed of the draws.
    pub seed: u64,
    /// The basins, without islands.
    pub basins: Vec<Basin>,
}

/// Computes the basins of `count` bicycles drawn from `measured`. Controller and rider are those of
/// `conditions`: they are tuned to the bicycle as measured. `finished` is called after each column, `stop` is
/// checked before each.
///
/// # Errors
/// None of the draws of a bicycle is possible, or a drawn bicycle can't be simulated.
pub fn drawn(
    conditions: &Conditions,
    measured: &Measured,
    search: &Search,
    count: u32,
    finished: impl Fn() + Sync,
    stop: impl Fn() -> bool + Sync,
) -> Result<Drawn, SearchError> {
    let seed = conditions.plant.seed;
    let ridden = |i: u32| {
        let parameters = measured.draw(seed, i.into())?;
        let drawn = Conditions { bicycle: Geometry::new(&parameters), ..conditions.clone() };
        drawn.check()?;
        Ok(drawn)
    };
    let all: Vec<Conditions> = (0..count).map(ridden).collect::<Result<_, SearchError>>()?;
    let speeds = &search.speeds;
    let columns: Vec<Option<Column>> = (0..all.len() * speeds.len())
        .into_par_iter()
        .map(|i| {
            let column =
                (!stop()).then(|| border(&all[i / speeds.len()], search, speeds[i % speeds.len()]))?;
            finished();
            Some(column)
        })
        .collect();
    let whole =
        |columns: &[Option<Column>]| Some(Basin { columns: columns.iter().cloned().collect::<Option<_>>()? });
    Ok(Drawn { seed, basins: columns.chunks(speeds.len().max(1)).filter_map(whole).collect() })
}

impl Drawn {
    /// The [`QUANTILES`] of a number of each basin, with linear interpolation between the draws.
    pub fn quantiles(&self, of: impl Fn(&Basin) -> f64) -> [f64; 3] {
        let mut all: Vec<f64> = self.basins.iter().map(of).collect();
        all.sort_by(f64::total_cmp);
        QUANTILES.map(|part| {
            let place = part * all.len().saturating_sub(1) as f64;
            let (low, high) = (place.floor() as usize, place.ceil() as usize);
            match (all.get(low), all.get(high)) {
                (Some(a), Some(b)) => a + (place - low as f64) * (b - a),
                _ => f64::NAN,
            }
        })
    }

    /// Quantiles of the height at each speed \[rad/s\].
    pub fn heights(&self) -> Vec<[f64; 3]> {
        let speeds = self.basins.first().map_or(0, |basin| basin.columns.len());
        (0..speeds).map(|i| self.quantiles(|basin| basin.columns[i].upper)).collect()
    }

    /// Number of draws with a height that is a lower bound.
    pub fn capped(&self) -> usize {
        self.basins.iter().filter(|basin| basin.capped()).count()
    }
}
