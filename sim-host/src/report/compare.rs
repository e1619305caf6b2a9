//! Document of `basin compare`.

use super::resolved::ResolvedSearch;
use super::tool::{SCHEMA, Tool};
use crate::basin::{Basin, Bound, Rmse, rmse};
use schemars::JsonSchema;
use serde::Serialize;

/// `basin compare`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct CompareDocument {
    /// 1.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: u32,
    /// The program.
    pub tool: Tool,
    /// The search of the computed cases.
    pub search: ResolvedSearch,
    /// False after an interruption: cases are then missing or cover fewer speeds.
    pub complete: bool,
    /// Names of the cases without a finished speed, which are missing from `cases` after an interruption.
    pub missing: Vec<String>,
    /// The cases, in the requested order.
    pub cases: Vec<CaseEntry>,
    /// Root-mean-square distance of each two outlines over their common speeds \[rad/s\]; null without any.
    pub rmse: Vec<Vec<Option<f64>>>,
    /// The same by eq. 2.22 as the thesis prints it, without 1/n \[rad/s\].
    pub rmse_as_printed: Vec<Vec<Option<f64>>>,
    /// Whether both distances are exact or bounds; null if the outlines have no common speed.
    pub rmse_is: Vec<Vec<Option<Bound>>>,
    /// Whether all cases cover the same speeds. If not, areas and means refer to different ranges.
    pub same_speeds: bool,
}

/// One case.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct CaseEntry {
    /// Its name.
    pub label: String,
    /// Its full configuration, as in the document of `basin`.
    pub config: serde_json::Value,
    /// The scenario that gives this case again; null for a file without one.
    pub scenario: serde_json::Value,
    /// Forward speeds \[m/s\].
    pub speeds: Vec<f64>,
    /// The outline \[rad/s\].
    pub upper: Vec<f64>,
    /// False after an interruption, also of the search in a file: speeds and all measures are then missing.
    pub complete: bool,
    /// Area under it, trapezoidal rule \[rad m/s^2\]; null at a single speed.
    pub area: Option<f64>,
    /// Mean height \[rad/s\].
    pub mean_height: Option<f64>,
    /// Area relative to the first case's; null if that is 0 or one of both has a single speed.
    pub relative_area: Option<f64>,
    /// Mean relative to the first case's; null if that is 0. At a single speed, which has no area, this is the
    /// comparison.
    pub relative_height: Option<f64>,
    /// Whether both ratios are exact or bounds.
    pub relative_is: Bound,
    /// Whether the height is a lower bound because nothing fell up to the largest rate tried, per speed.
    pub capped: Vec<bool>,
    /// Whether area and mean are lower bounds.
    pub area_capped: bool,
}

/// A case to compare.
#[derive(Clone, Debug)]
pub struct Case {
    /// Its name.
    pub label: String,
    /// Its full configuration.
    pub config: serde_json::Value,
    /// Its scenario; null if unknown.
    pub scenario: serde_json::Value,
    /// Its outline; a case from a file has no scan and no border rides.
    pub basin: Basin,
    /// Whether all its speeds are searched; it has no area and no mean height otherwise.
    pub complete: bool,
}

impl Case {
    fn area(&self) -> Option<f64> {
        self.basin.enclosed_area().filter(|_| self.complete)
    }

    fn mean_height(&self) -> Option<f64> {
        self.basin.mean_height().filter(|_| self.complete)
    }
}

impl CompareDocument {
    /// The document of some cases; `missing` are the names of those without a finished speed.
    pub fn new(search: ResolvedSearch, cases: &[Case], complete: bool, missing: Vec<String>) -> Self {
        let first = cases.first().and_then(Case::area).unwrap_or(0.0);
        let first_mean = cases.first().and_then(Case::mean_height).unwrap_or(0.0);
        let first_capped = cases.first().is_some_and(|c| c.basin.capped());
        // The first case relative to itself is exactly 1, even if its height is a bound.
        let relative_is = |case: &Case| match cases.first() {
            Some(first) if first.label == case.label => Bound::Measured,
            _ => Bound::of_ratio(case.basin.capped(), first_capped),
        };
        let speeds = |case: &Case| case.basin.columns.iter().map(|c| c.speed).collect::<Vec<_>>();
        let entry = |case: &Case| CaseEntry {
            label: case.label.clone(),
            config: case.config.clone(),
            scenario: case.scenario.clone(),
            speeds: speeds(case),
            upper: case.basin.columns.iter().map(|c| c.upper).collect(),
            complete: case.complete,
            area: case.area(),
            mean_height: case.mean_height(),
            relative_area: case.area().filter(|_| first > 0.0).map(|area| area / first),
            relative_height: case.mean_height().filter(|_| first_mean > 0.0).map(|m| m / first_mean),
            relative_is: relative_is(case),
            capped: case.basin.columns.iter().map(|c| c.capped).collect(),
            area_capped: case.basin.capped(),
        };
        let distances = |of: fn(Rmse) -> f64| between(cases, of);
        Self {
            schema: SCHEMA,
            tool: Tool::this(),
            search,
            complete,
            missing,
            cases: cases.iter().map(entry).collect(),
            rmse: distances(|r| r.mean),
            rmse_as_printed: distances(|r| r.as_printed),
            rmse_is: between(cases, |r| r.bound),
            same_speeds: cases.windows(2).all(|pair| speeds(&pair[0]) == speeds(&pair[1])),
        }
    }

    /// Whether there is a single speed, and so no area.
    pub fn one_speed(&self) -> bool {
        self.cases.iter().all(|case| case.speeds.len() < 2)
    }
}

/// A measure of the distance between each two cases; the distance of a case to itself is exact, even if its height is a
/// bound.
fn between<T>(cases: &[Case], of: impl Fn(Rmse) -> T) -> Vec<Vec<Option<T>>> {
    let distance = |i: usize, j: usize| {
        let found = rmse(&cases[i].basin, &cases[j].basin)?;
        Some(of(if i == j { Rmse { bound: Bound::Measured, ..found } } else { found }))
    };
    (0..cases.len()).map(|i| (0..cases.len()).map(|j| distance(i, j)).collect()).collect()
}
