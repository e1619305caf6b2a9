//! Basin search: a scan over disturbances, then each border is narrowed to the tolerance.

use super::{Basin, Column, Island, ScanPoint, Work};
use crate::bicycle::uncertain::DrawError;
use crate::range::{RangeError, within};
use crate::ride::{Conditions, ConditionsError, FallCause, RemoteError, Ride, Start, rides};
use crate::rider::ScheduleError;
use rayon::prelude::*;
use std::convert::Infallible;

/// Which rate the disturbance changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// The steer rate.
    SteerRate,
    /// The roll rate.
    RollRate,
}

impl Axis {
    /// Initial state of a ride at `speed` \[m/s\] with a disturbance of `rate` \[rad/s\].
    pub fn start(self, speed: f64, rate: f64) -> Start {
        let steady = Start { speed_m_s: speed, ..Start::default() };
        match self {
            Axis::SteerRate => Start { steer_rate_rad_s: rate, ..steady },
            Axis::RollRate => Start { roll_rate_rad_s: rate, ..steady },
        }
    }
}

/// Range and resolution of the search.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Search {
    /// Forward speeds \[m/s\], increasing.
    pub speeds: Vec<f64>,
    /// The disturbed rate.
    pub axis: Axis,
    /// Largest disturbance tried \[rad/s\].
    pub max_rate: f64,
    /// Step of the scan \[rad/s\]: islands and gaps narrower than this can be missed.
    pub scan_step: f64,
    /// Tolerance of the borders \[rad/s\].
    pub tolerance: f64,
}

/// A search that can't be done.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SearchError {
    /// A value outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// Speeds that do not rise \[m/s\].
    #[error("speeds must rise: {after} m/s comes after {before} m/s")]
    Order {
        /// A speed.
        before: f64,
        /// The next one.
        after: f64,
    },
    /// Conditions that can't be simulated.
    #[error(transparent)]
    Conditions(#[from] ConditionsError),
    /// A changed schedule of the rider.
    #[error(transparent)]
    Schedule(#[from] ScheduleError),
    /// No bicycle can be drawn.
    #[error(transparent)]
    Draw(#[from] DrawError),
    /// A sensitivity where no ride falls.
    #[error("nothing falls up to {max_rate} rad/s at {speed} m/s: a lower bound has no sensitivity")]
    NothingFalls {
        /// Largest disturbance tried \[rad/s\].
        max_rate: f64,
        /// Forward speed \[m/s\].
        speed: f64,
    },
}

impl From<SearchError> for RemoteError {
    fn from(error: SearchError) -> Self {
        Self(error.into())
    }
}

/// Rides between the two ends of an interval in one round of narrowing: the number of lanes.
const SECTIONS: usize = 8;

impl Search {
    /// Checks ranges.
    ///
    /// # Errors
    /// States the value and its range.
    pub fn check(&self) -> Result<(), SearchError> {
        within("number of speeds", self.speeds.len() as f64, 1.0, 100_000.0)?;
        for &v in &self.speeds {
            within("speed (m/s)", v, 0.0, 30.0)?;
        }
        if let Some(pair) = self.speeds.windows(2).find(|pair| pair[1] <= pair[0]) {
            return Err(SearchError::Order { before: pair[0], after: pair[1] });
        }
        within("max rate (rad/s)", self.max_rate, 0.01, 100.0)?;
        within("scan step (rad/s)", self.scan_step, 1e-3, self.max_rate)?;
        within("tolerance (rad/s)", self.tolerance, 1e-9, self.scan_step)?;
        Ok(())
    }
}

/// Computes the basin at every speed, on all cores of the current rayon pool. `finished` is called after each
/// column, `stop` is checked before each. The result does not depend on the number of threads.
///
/// # Errors
/// The search or the conditions fail their checks.
pub fn basin(
    conditions: &Conditions,
    search: &Search,
    finished: impl Fn(&Column) + Sync,
    stop: impl Fn() -> bool + Sync,
) -> Result<Basin, SearchError> {
    basin_by(conditions, search, |starts| Ok(rides(conditions, starts)), finished, stop)
}

/// As [`basin`], with rides simulated by `rides`, which returns them in the order of the starts.
///
/// # Errors
/// The search or the conditions fail their checks, or `rides` fails.
pub fn basin_by<E: From<SearchError> + Send>(
    conditions: &Conditions,
    search: &Search,
    rides: impl Fn(&[Start]) -> Result<Vec<Ride>, E> + Sync,
    finished: impl Fn(&Column) + Sync,
    stop: impl Fn() -> bool + Sync,
) -> Result<Basin, E> {
    search.check()?;
    conditions.check().map_err(SearchError::from)?;
    let columns: Result<Vec<Option<Column>>, E> = search
        .speeds
        .par_iter()
        .map(|&speed| {
            if stop() {
                return Ok(None);
            }
            let column = explored(&rides, search, &|rate| search.axis.start(speed, rate), usize::MAX)?;
            finished(&column);
            Ok(Some(column))
        })
        .collect();
    Ok(Basin { columns: columns?.into_iter().flatten().collect() })
}

/// The basin at one speed.
pub fn column(conditions: &Conditions, search: &Search, speed: f64) -> Column {
    along(conditions, search, &|rate| search.axis.start(speed, rate))
}

/// The basin along any line of disturbances: `start` gives the initial state for a disturbance of 0 to
/// `search.max_rate`. The search's axis is not used.
pub(super) fn along(conditions: &Conditions, search: &Search, start: &dyn Fn(f64) -> Start) -> Column {
    let Ok(column) = explored(&ridden(conditions), search, start, usize::MAX);
    column
}

/// The basin at one speed without islands: the scan ends soon after the first fall. `upper` equals that of
/// [`column`].
pub fn border(conditions: &Conditions, search: &Search, speed: f64) -> Column {
    let start = |rate| search.axis.start(speed, rate);
    let Ok(column) = explored(&ridden(conditions), search, &start, SECTIONS);
    Column { islands: Vec::new(), ..column }
}

/// [`rides`] as an infallible function for [`explored`].
fn ridden(conditions: &Conditions) -> impl Fn(&[Start]) -> Result<Vec<Ride>, Infallible> {
    |starts| Ok(rides(conditions, starts))
}

/// Scans in groups of `group` rides, to the end or the first group with a fall, and narrows the borders.
fn explored<E>(
    rides: &impl Fn(&[Start]) -> Result<Vec<Ride>, E>,
    search: &Search,
    start: &dyn Fn(f64) -> Start,
    group: usize,
) -> Result<Column, E> {
    let speed = start(0.0).speed_m_s;
    let mut work = Work::default();
    let mut ride = |rates: &[f64]| -> Result<Vec<Ride>, E> {
        let starts: Vec<Start> = rates.iter().map(|&r| start(r)).collect();
        let done = rides(&starts)?;
        work.add(&done);
        Ok(done)
    };
    // The last point is the largest rate, even if it is not a multiple of the scan step.
    let points = (search.max_rate / search.scan_step - 1e-9).ceil() as usize;
    let rates: Vec<f64> = (1..=points).map(|i| (i as f64 * search.scan_step).min(search.max_rate)).collect();
    let mut scan: Vec<Ride> = Vec::new();
    for group in rates.chunks(group.min(points.max(1))) {
        scan.extend(ride(group)?);
        if scan.iter().any(Ride::fell) {
            break;
        }
    }
    // The undisturbed ride does not fall; there is a border wherever consecutive points differ.
    let mut runs: Vec<Island> = Vec::new();
    let (mut border, mut beyond) = (None, None);
    let mut open = Some((0.0, None));
    let (mut last_rate, mut last_fell, mut last_ride) = (0.0, false, None);
    for (&rate, now) in rates.iter().zip(&scan) {
        if now.fell() && !last_fell {
            let (to, at, by) =
                narrow(&mut ride, last_rate, (rate, now.outcome.fall()), search.tolerance, last_ride)?;
            if let Some((from, _)) = open.take() {
                runs.push(Island { from, to });
                if runs.len() == 1 {
                    (border, beyond) = (at, by);
                }
            }
        } else if !now.fell() && last_fell {
            let (from, at, _) = narrow(&mut ride, rate, (last_rate, None), search.tolerance, Some(*now))?;
            open = Some((from, at));
        }
        (last_rate, last_fell, last_ride) = (rate, now.fell(), Some(*now));
    }
    let capped = runs.is_empty();
    if let Some((from, _)) = open {
        runs.push(Island { from, to: search.max_rate });
        if capped {
            border = last_ride;
        }
    }
    let upper = runs.first().map_or(0.0, |run| run.to);
    let scan = rates.iter().zip(&scan).map(|(&rate, r)| ScanPoint { rate, outcome: r.outcome }).collect();
    Ok(Column { speed, upper, capped, islands: runs.split_off(1), scan, border, beyond, work })
}

/// Narrows a border to `tolerance`: returns the closest rate found not to fall, its ride, and the cause of
/// the fall on the other side. `safe` did not fall; `fell` did, by the cause `by`; either can be the larger.
pub(super) fn narrow<E>(
    ride: &mut impl FnMut(&[f64]) -> Result<Vec<Ride>, E>,
    mut safe: f64,
    (mut fell, mut by): (f64, Option<FallCause>),
    tolerance: f64,
    mut at: Option<Ride>,
) -> Result<(f64, Option<Ride>, Option<FallCause>), E> {
    while (fell - safe).abs() > tolerance {
        let cell = (fell - safe) / (SECTIONS + 1) as f64;
        let rates: Vec<f64> = (1..=SECTIONS).map(|i| safe + i as f64 * cell).collect();
        let done = ride(&rates)?;
        match done.iter().position(Ride::fell) {
            Some(first) => {
                (fell, by) = (rates[first], done[first].outcome.fall());
                if first > 0 {
                    (safe, at) = (rates[first - 1], Some(done[first - 1]));
                }
            }
            None => (safe, at) = (rates[SECTIONS - 1], Some(done[SECTIONS - 1])),
        }
    }
    Ok((safe, at, by))
}
