//! A search in rounds: from few speeds to all, and on to further speeds where the outline bends or jumps.

use super::search::in_parallel;
use super::{Basin, Column, Island, Search, SearchError};
use crate::range::within_key;
use crate::ride::Conditions;

/// Smallest step of adaptive speeds \[m/s\]: intervals below twice this are not halved.
pub const SMALLEST_STEP: f64 = 0.0125;

/// Number of intervals of a first round, at least.
const FIRST: usize = 6;

/// Which speeds are computed after which.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rounds {
    /// Whether the first round is a part of the given speeds, spread over their range, and the second the others, coarse
    /// before fine. The basin has the same bits.
    pub coarse_first: bool,
    /// Tolerance of adaptive speeds, as a part of the largest height, 0.0001 to 1. `None`: the given speeds only.
    ///
    /// An interval is halved if one of its ends deviates by more than this from the straight line between the speeds beside
    /// it, or if an island wider than this exists at only one of its ends. The lower border is the mirror image of the upper.
    pub adaptive: Option<f64>,
}

/// A basin and its speeds, of which some are not computed after an interruption.
#[derive(Clone, Debug, PartialEq)]
pub struct Refined {
    /// The given speeds and those that were added \[m/s\], increasing.
    pub speeds: Vec<f64>,
    /// The basin.
    pub basin: Basin,
}

/// As [`basin`](super::basin), in rounds: the speeds of each are computed on all cores before those of the next. `added` gets the number
/// of added speeds before each round of them. The result does not depend on the number of threads.
///
/// # Errors
/// The search, the tolerance or the conditions fail their checks.
pub fn basin_in_rounds(
    conditions: &Conditions,
    search: &Search,
    rounds: Rounds,
    added: impl Fn(usize),
    finished: impl Fn(&Column) + Sync,
    stop: impl Fn() -> bool + Sync,
) -> Result<Refined, SearchError> {
    search.check()?;
    rounds.check()?;
    conditions.check()?;
    let columns = |speeds: &[f64]| in_parallel(conditions, search, speeds, &finished, &stop);
    let mut found = Refined { speeds: search.speeds.clone(), basin: Basin { columns: Vec::new() } };
    let given =
        if rounds.coarse_first { coarse_first(&search.speeds) } else { [search.speeds.clone(), Vec::new()] };
    for speeds in given {
        found.basin.columns.extend(columns(&speeds));
    }
    loop {
        found = found.sorted();
        let complete = found.basin.columns.len() == found.speeds.len();
        let tolerance = rounds.adaptive.filter(|_| complete);
        let between = tolerance.map_or(Vec::new(), |tolerance| midpoints(&found.basin, tolerance));
        if between.is_empty() {
            return Ok(found);
        }
        added(between.len());
        found.speeds.extend(&between);
        found.basin.columns.extend(columns(&between));
    }
}

impl Rounds {
    /// Checks the tolerance.
    ///
    /// # Errors
    /// States the value and its range.
    pub fn check(&self) -> Result<(), SearchError> {
        let name = "adaptive speeds (part of the largest height)";
        let checked = |part| within_key("search.adaptive_speeds", name, part, 1e-4, 1.0);
        let tolerance = self.adaptive.map(checked);
        Ok(tolerance.transpose().map(drop)?)
    }
}

impl Refined {
    /// With increasing speeds.
    fn sorted(mut self) -> Self {
        self.speeds.sort_by(f64::total_cmp);
        self.basin.columns.sort_by(|a, b| a.speed.total_cmp(&b.speed));
        self
    }
}

/// The speeds in two rounds: first and last and every so many between; then those halfway, those halfway between these, and
/// so on.
fn coarse_first(speeds: &[f64]) -> [Vec<f64>; 2] {
    let last = speeds.len().saturating_sub(1);
    let mut step = 1;
    while last / (2 * step) >= FIRST {
        step *= 2;
    }
    let first = |i: usize| i.is_multiple_of(step) || i == last;
    let (first, mut rest): (Vec<usize>, Vec<usize>) = (0..speeds.len()).partition(|&i| first(i));
    // The more often an index can be halved, the coarser its step; the sort is stable.
    rest.sort_by_key(|i| std::cmp::Reverse(i.trailing_zeros()));
    [first, rest].map(|round| round.into_iter().map(|i| speeds[i]).collect())
}

/// The middles of the intervals of speed that need one \[m/s\], increasing.
fn midpoints(basin: &Basin, tolerance: f64) -> Vec<f64> {
    let columns = &basin.columns;
    let allowed = tolerance * columns.iter().map(|c| c.upper).fold(0.0, f64::max);
    // Two columns alone always are on a straight line.
    let mut halved = vec![columns.len() == 2; columns.len().saturating_sub(1)];
    for (i, [before, at, after]) in columns.array_windows().enumerate() {
        if deviation(before, at, after, allowed) > allowed {
            (halved[i], halved[i + 1]) = (true, true);
        }
    }
    for (i, [from, to]) in columns.array_windows().enumerate() {
        halved[i] |= wide(from, allowed).count() != wide(to, allowed).count();
    }
    let intervals = columns.array_windows().zip(halved).filter(|(_, halved)| *halved);
    let wide = intervals
        .map(|([from, to], _)| (from.speed, to.speed))
        .filter(|(from, to)| to - from >= 2.0 * SMALLEST_STEP - 1e-9);
    // Rounded to a billionth, as the speeds of a range.
    wide.map(|(from, to)| (0.5 * (from + to) * 1e9).round() / 1e9).collect()
}

/// The islands wider than `allowed` \[rad/s\].
fn wide(column: &Column, allowed: f64) -> impl Iterator<Item = &Island> {
    column.islands.iter().filter(move |island| island.to - island.from > allowed)
}

/// Largest distance of a column from the straight line between those beside it, over the border and, if all three have the
/// same number, the ends of wide islands \[rad/s\].
fn deviation(before: &Column, at: &Column, after: &Column, allowed: f64) -> f64 {
    let part = (at.speed - before.speed) / (after.speed - before.speed);
    let ends = [before, at, after].map(|column| -> Vec<f64> {
        let islands = wide(column, allowed).flat_map(|island| [island.from, island.to]);
        std::iter::once(column.upper).chain(islands).collect()
    });
    let [before, at, after] = &ends;
    let same = before.len() == at.len() && at.len() == after.len();
    let compared = if same { at.len() } else { 1 };
    let distance = |i: usize| (at[i] - before[i] - part * (after[i] - before[i])).abs();
    (0..compared).map(distance).fold(0.0, f64::max)
}
