//! Basins of bicycles drawn from the measured uncertainties of a bicycle, and of riders drawn from those of their gains.

use super::{Basin, Column, Search, SearchError, border};
use crate::bicycle::Geometry;
use crate::bicycle::uncertain::Measured;
use crate::ride::Conditions;
use crate::rider::{Drawing, Fit, Outside, RiderTable};
use rayon::prelude::*;

/// Probabilities of the reported quantiles.
pub const QUANTILES: [f64; 3] = [0.05, 0.5, 0.95];

/// Basins of drawn bicycles or riders; only those computed at every speed.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// Seed of the draws.
    pub seed: u64,
    /// The basins, without islands.
    pub basins: Vec<Basin>,
    /// Their numbers among the draws, from 0.
    pub numbers: Vec<usize>,
}

/// The conditions with each of `count` bicycles drawn from `measured` by the seed of the conditions' plant. Controller
/// and rider stay: they are tuned to the bicycle as measured.
///
/// # Errors
/// None of the draws of a bicycle is possible, or a drawn bicycle can't be simulated.
pub fn drawn_bicycles(
    conditions: &Conditions,
    measured: &Measured,
    count: u32,
) -> Result<Vec<Conditions>, SearchError> {
    let ridden = |i: u32| {
        let parameters = measured.draw(conditions.plant.seed, i.into())?;
        let drawn = Conditions { bicycle: Geometry::new(&parameters), ..conditions.clone() };
        drawn.check()?;
        Ok(drawn)
    };
    (0..count).map(ridden).collect()
}

/// The conditions with each of `count` riders drawn from `table` by the seed of the conditions' plant, each scheduled by
/// `fit` and with the delay of the conditions' rider.
///
/// # Errors
/// No schedule fits drawn gains, or a drawn rider can't be simulated.
pub fn drawn_riders(
    conditions: &Conditions,
    (table, drawing): (&RiderTable, Drawing),
    (fit, outside): (Fit, Outside),
    count: u32,
) -> Result<Vec<Conditions>, SearchError> {
    let delay_s = conditions.rider.as_ref().map(|rider| rider.delay_s);
    let ridden = |i: u32| {
        let drawn = table.drawn(drawing, conditions.plant.seed, i.into());
        let drawn = Conditions { rider: Some(drawn.rider(fit, outside, delay_s)?), ..conditions.clone() };
        drawn.check()?;
        Ok(drawn)
    };
    (0..count).map(ridden).collect()
}

/// Computes the basins of all `draws`, made with `seed`. `finished` is called after each column, `stop` is checked
/// before each.
pub fn drawn(
    draws: &[Conditions],
    seed: u64,
    search: &Search,
    finished: impl Fn() + Sync,
    stop: impl Fn() -> bool + Sync,
) -> Drawn {
    let search = &Search { efforts: false, ..search.clone() };
    let speeds = &search.speeds;
    let columns: Vec<Option<Column>> = (0..draws.len() * speeds.len())
        .into_par_iter()
        .map(|i| {
            let column =
                (!stop()).then(|| border(&draws[i / speeds.len()], search, speeds[i % speeds.len()]))?;
            finished();
            Some(column)
        })
        .collect();
    let whole = |(i, columns): (usize, &[Option<Column>])| {
        Some((i, Basin { columns: columns.iter().cloned().collect::<Option<_>>()? }))
    };
    let (numbers, basins) = columns.chunks(speeds.len().max(1)).enumerate().filter_map(whole).unzip();
    Drawn { seed, basins, numbers }
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
