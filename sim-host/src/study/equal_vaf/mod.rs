//! Study of the basins of gain sets that describe the same run equally well: the open question of Kuipers 2020,
//! appendices H and I.

mod page;

use super::page::Page;
use crate::basin::{Axis, Column, Method, Search, border, drawn, drawn_riders};
use crate::bicycle::catalogue::{self, BicycleError};
use crate::bicycle::{Geometry, Parameters};
use crate::eigen::{Feedback, Model, rightmost};
use crate::ride::{Assist, Conditions};
use crate::rider::{self, Drawing, Fit, Outside, Rider, RiderError, RiderTable, Row, Schedule};
use crate::thesis::published::published;
use control::Law;
use rayon::prelude::*;

/// The name of the page.
pub const NAME: &str = "equal-vaf";
/// Title of the page.
pub const TITLE: &str = "Equally good gains, different basins";
/// The question that the study answers.
pub const QUESTION: &str =
    "How different are the basins of gain sets that describe the same run equally well?";
/// Riders whose rows are sets of gains for one run per speed.
const REDUCTIONS: [&str; 3] = ["undelayed-reduction", "young-reduction", "smart-reduction"];
/// Smallest variance accounted for \[%\] of a set that describes its run, as in the thesis.
const GOOD: f64 = 90.0;
/// The rider of the band: its groups have three runs each.
const BAND: &str = "young";
/// The bicycle of the runs.
const BICYCLE: &str = "rigid_jason";

/// How much is computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Extent {
    /// The search; its speeds are those of the band.
    pub search: Search,
    /// Number of drawn riders, at least 2.
    pub draws: u32,
}

impl Extent {
    /// The extent of the page.
    pub fn page() -> Self {
        let speeds = (4..=15).map(|i| 0.5 * f64::from(i)).collect();
        let search = Search {
            speeds,
            axis: Axis::SteerRate,
            max_rate: 30.0,
            scan_step: 0.1,
            tolerance: 0.01,
            method: Method::Fast,
            efforts: false,
        };
        Self { search, draws: 100 }
    }
}

/// A study that cannot be computed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EqualVafError {
    /// The bicycle cannot be loaded.
    #[error(transparent)]
    Bicycle(#[from] BicycleError),
    /// A rider cannot be loaded.
    #[error(transparent)]
    Rider(#[from] RiderError),
    /// A rider cannot be scheduled.
    #[error(transparent)]
    Schedule(#[from] rider::ScheduleError),
    /// A drawn rider cannot be simulated.
    #[error(transparent)]
    Search(#[from] crate::basin::SearchError),
}

/// A set of gains that describes its run, and its basin at the run's speed.
#[derive(Clone, Debug, PartialEq)]
pub struct Set {
    /// The rider's neural delay \[ms\].
    pub delay_ms: f64,
    /// The run.
    pub run: u32,
    /// Its speed \[m/s\].
    pub speed_m_s: f64,
    /// Number of gains that are not zero.
    pub gains: usize,
    /// Variance accounted for \[%\], as printed.
    pub vaf: f64,
    /// Growth of small disturbances by the linear model, the rightmost root's real part \[1/s\]; negative if stable.
    pub growth: f64,
    /// Height of the basin \[rad/s\].
    pub height: f64,
    /// Whether the height is a lower bound.
    pub capped: bool,
    /// Printed height \[rad/s\], to 0.1, if there is one.
    pub printed: Option<f64>,
}

/// Computes the study; `None` if `stop` interrupted it. `advanced` is called for each column.
///
/// # Errors
/// A built-in bicycle or rider cannot be loaded or drawn.
pub fn study(
    extent: &Extent,
    advanced: &(dyn Fn() + Sync),
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Page>, EqualVafError> {
    let parameters = catalogue::load(BICYCLE)?.parameters;
    let bicycle = Geometry::new(&parameters);
    let conditions = |rider| Conditions { rider: Some(rider), ..Conditions::thesis(bicycle, Assist::None) };
    let tables = REDUCTIONS.map(rider::catalogue::load).into_iter().collect::<Result<Vec<_>, _>>()?;
    let Some(sets) = sets(&tables, &parameters, conditions, &extent.search, advanced, stop) else {
        return Ok(None);
    };
    let young = rider::catalogue::load(BAND)?;
    let fit = (Fit::default(), Outside::default());
    let measured = conditions(young.rider(fit.0, fit.1, None)?);
    let draws = drawn_riders(&measured, (&young, Drawing::Bootstrap), fit, extent.draws)?;
    let band = drawn(&draws, measured.plant.seed, &extent.search, advanced, stop);
    if band.basins.len() < draws.len() {
        return Ok(None);
    }
    let page = Page {
        name: NAME,
        text: page::text(&sets, &band, extent),
        chart: page::figure(&sets, &band, extent),
    };
    Ok(Some(page))
}

/// Number of columns that the study computes.
///
/// # Errors
/// A built-in rider cannot be loaded.
pub fn work(extent: &Extent) -> Result<usize, EqualVafError> {
    let tables = REDUCTIONS.map(rider::catalogue::load).into_iter().collect::<Result<Vec<_>, _>>()?;
    Ok(good(&tables).count() + extent.draws as usize * extent.search.speeds.len())
}

/// The rows that describe their run, with their table.
fn good(tables: &[RiderTable]) -> impl Iterator<Item = (&RiderTable, &Row)> {
    let rows = tables.iter().flat_map(|table| table.rows.iter().map(move |row| (table, row)));
    rows.filter(|(_, row)| row.vaf.is_some_and(|vaf| vaf >= GOOD))
}

fn sets(
    tables: &[RiderTable],
    bicycle: &Parameters,
    conditions: impl Fn(Rider) -> Conditions + Sync,
    search: &Search,
    advanced: &(dyn Fn() + Sync),
    stop: &(dyn Fn() -> bool + Sync),
) -> Option<Vec<Set>> {
    let rows: Vec<(&RiderTable, &Row)> = good(tables).collect();
    rows.into_par_iter()
        .map(|(table, row)| {
            if stop() {
                return None;
            }
            let rider = Rider {
                schedule: Schedule::constant(row.gains),
                delay_s: table.delay_s,
                neuromuscular: table.neuromuscular,
            };
            let linear = Model::new(bicycle, Feedback::Law(Law::None), Some(rider.clone()));
            let Column { upper, capped, .. } = border(&conditions(rider), search, row.speed_m_s);
            advanced();
            Some(Set {
                delay_ms: (table.delay_s * 1e3).round(),
                run: row.run.unwrap_or_default(),
                speed_m_s: row.speed_m_s,
                gains: row.gains.0.iter().filter(|gain| **gain != 0.0).count(),
                vaf: row.vaf.unwrap_or_default(),
                growth: rightmost(&linear.at(row.speed_m_s)).re,
                height: upper,
                capped,
                printed: printed(table, row),
            })
        })
        .collect()
}

/// Height of a set in Table I.1 or I.2.
fn printed(table: &RiderTable, row: &Row) -> Option<f64> {
    let of_run = published().height.iter().filter(|heights| {
        Some(heights.run) == row.run && (heights.delay_ms - table.delay_s * 1e3).abs() < 0.5
    });
    let same = |set: &&crate::thesis::published::GainRow| set.gains[..] == row.gains.0[..8];
    of_run
        .flat_map(|heights| &heights.rows)
        .find(same)
        .map(|set| set.height)
        .filter(|height| height.is_finite())
}
