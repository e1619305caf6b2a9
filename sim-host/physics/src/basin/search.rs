//! Basin search: a scan over disturbances, then each border is narrowed to the tolerance.

use super::plain::{explored, plain, ridden};
use super::{Basin, Column, fast};
use crate::bicycle::uncertain::DrawError;
use crate::range::{RangeError, within_key};
use crate::ride::{Conditions, ConditionsError, Quick, RemoteError, Ride, Start, side_by_side};
use crate::rider::ScheduleError;
use rayon::prelude::*;

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

/// How the rides of a search are simulated.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema,
)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Long steps find the borders and exact rides confirm them, if only controller, constant delays, a lag of the motor and rider act; otherwise as plain.
    #[default]
    Fast,
    /// Every ride exact and to its end.
    Plain,
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
    /// How the rides are simulated.
    pub method: Method,
    /// Whether [`Column::border`] is wanted: those rides last to the time limit. A fast search without it ends them as soon as their
    /// outcome is decided.
    pub efforts: bool,
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

impl SearchError {
    /// The number outside its range, if there is one.
    pub fn range(&self) -> Option<&RangeError> {
        match self {
            Self::Range(error) => Some(error),
            Self::Conditions(error) => error.range(),
            _ => None,
        }
    }
}

impl From<SearchError> for RemoteError {
    fn from(error: SearchError) -> Self {
        Self(error.into())
    }
}

impl Search {
    /// Checks ranges.
    ///
    /// # Errors
    /// States the value and its range.
    pub fn check(&self) -> Result<(), SearchError> {
        within_key("search.speeds", "number of speeds", self.speeds.len() as f64, 1.0, 100_000.0)?;
        for &v in &self.speeds {
            within_key("search.speeds", "speed (m/s)", v, 0.0, 30.0)?;
        }
        if let Some(pair) = self.speeds.windows(2).find(|pair| pair[1] <= pair[0]) {
            return Err(SearchError::Order { before: pair[0], after: pair[1] });
        }
        within_key("search.max_rate", "max rate (rad/s)", self.max_rate, 0.01, 100.0)?;
        within_key("search.scan_step", "scan step (rad/s)", self.scan_step, 1e-3, self.max_rate)?;
        within_key("search.tolerance", "tolerance (rad/s)", self.tolerance, 1e-9, self.scan_step)?;
        Ok(())
    }

    /// Quick rides, if the search may use them and they exist for the conditions.
    fn quick<'a>(&self, conditions: &'a Conditions) -> Option<Quick<'a>> {
        (self.method == Method::Fast).then(|| Quick::new(conditions)).flatten()
    }
}

/// Computes the basin at every speed, on all cores of the current rayon pool. `finished` is called after each
/// column, `stop` is checked before each or, in a fast search, before as many as are searched together. The result
/// does not depend on the number of threads.
///
/// # Errors
/// The search or the conditions fail their checks.
pub fn basin(
    conditions: &Conditions,
    search: &Search,
    finished: impl Fn(&Column) + Sync,
    stop: impl Fn() -> bool + Sync,
) -> Result<Basin, SearchError> {
    search.check()?;
    conditions.check()?;
    Ok(Basin { columns: in_parallel(conditions, search, &search.speeds, finished, stop) })
}

/// The columns at `speeds` \[m/s\] in their order, as [`basin`] computes them; the search's own speeds are not used.
pub(super) fn in_parallel(
    conditions: &Conditions,
    search: &Search,
    speeds: &[f64],
    finished: impl Fn(&Column) + Sync,
    stop: impl Fn() -> bool + Sync,
) -> Vec<Column> {
    let explored = |speeds: &[f64]| {
        if stop() {
            return Vec::new();
        }
        let columns = columns(conditions, search, speeds);
        columns.iter().for_each(&finished);
        columns
    };
    let together = together(conditions, search, speeds.len());
    speeds.par_chunks(together).flat_map_iter(explored).collect()
}

/// Number of speeds, or of other lines of disturbances, to search together if `left` are to be searched in all: in a fast search at
/// most twice as many as rides are simulated side by side, so that the exact rides, two or more for each line, fill the lanes; about
/// as many in every group, and no more than leaves some for every thread of the current rayon pool; in a plain search one.
pub fn together(conditions: &Conditions, search: &Search, left: usize) -> usize {
    let most = search.quick(conditions).map_or(1, |_| 2 * side_by_side());
    let of_thread = left.div_ceil(rayon::current_num_threads()).max(1);
    of_thread.div_ceil(of_thread.div_ceil(most))
}

/// As [`basin`], with exact rides only, simulated by `rides`, which returns them in the order of the starts.
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
            let column = explored(&rides, search, &|rate| search.axis.start(speed, rate), false)?;
            finished(&column);
            Ok(Some(column))
        })
        .collect();
    Ok(Basin { columns: columns?.into_iter().flatten().collect() })
}

/// The basin at one speed.
pub fn column(conditions: &Conditions, search: &Search, speed: f64) -> Column {
    columns(conditions, search, &[speed]).remove(0)
}

/// The basins at some speeds \[m/s\], in one thread; best as many as [`together`] states.
pub fn columns(conditions: &Conditions, search: &Search, speeds: &[f64]) -> Vec<Column> {
    along(conditions, search, &lines(search, speeds))
}

/// The lines of disturbances at some speeds.
fn lines<'a>(search: &'a Search, speeds: &'a [f64]) -> Vec<impl Fn(f64) -> Start + 'a> {
    speeds.iter().map(|&speed| move |rate| search.axis.start(speed, rate)).collect()
}

/// The basins along lines of disturbances: each gives the initial state for a disturbance of 0 to `search.max_rate`. The
/// search's axis is not used.
pub(super) fn along<L: Fn(f64) -> Start>(
    conditions: &Conditions,
    search: &Search,
    lines: &[L],
) -> Vec<Column> {
    match search.quick(conditions) {
        Some(quick) => fast::columns(conditions, quick, search, lines),
        None => lines.iter().map(|line| plain(conditions, search, line)).collect(),
    }
}

/// The basin at one speed without islands: the scan ends soon after the first fall. `upper` equals that of
/// [`column()`].
pub fn border(conditions: &Conditions, search: &Search, speed: f64) -> Column {
    borders(conditions, search, &[speed]).remove(0)
}

/// As [`border`] at some speeds \[m/s\], in one thread; best as many as [`together`] states.
pub fn borders(conditions: &Conditions, search: &Search, speeds: &[f64]) -> Vec<Column> {
    let lines = lines(search, speeds);
    if let Some(quick) = search.quick(conditions) {
        return fast::borders(conditions, quick, search, &lines);
    }
    let first = |line| {
        let Ok(column) = explored(&ridden(conditions), search, line, true);
        column
    };
    lines.iter().map(|line| first(line)).collect()
}
