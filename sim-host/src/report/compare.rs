//! The document of `basin compare`.

use super::document::SCHEMA;
use super::resolved::{ResolvedSearch, Tool};
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
    /// What was searched for the cases that were computed.
    pub search: ResolvedSearch,
    /// False after an interruption: then cases are missing or cover fewer speeds.
    pub complete: bool,
    /// The cases, in the order asked for.
    pub cases: Vec<CaseEntry>,
    /// Root-mean-square distance of each two outlines over the speeds they share \[rad/s\]; null if
    /// they share none.
    pub rmse: Vec<Vec<Option<f64>>>,
    /// The same as the thesis prints its eq. 2.22, without 1/n \[rad/s\].
    pub rmse_as_printed: Vec<Vec<Option<f64>>>,
    /// How both distances lie to the true ones; null if the outlines share no speed.
    pub rmse_is: Vec<Vec<Option<Bound>>>,
    /// Whether all cases cover the same speeds. If not, areas and means are not of the same range.
    pub same_speeds: bool,
}

/// One case.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct CaseEntry {
    /// Its name.
    pub label: String,
    /// Its full configuration, as in the document of `basin`.
    pub config: serde_json::Value,
    /// Forward speeds \[m/s\].
    pub speeds: Vec<f64>,
    /// The outline \[rad/s\].
    pub upper: Vec<f64>,
    /// Area under it, trapezoidal rule \[rad m/s^2\].
    pub area: f64,
    /// Its mean \[rad/s\].
    pub mean_height: Option<f64>,
    /// Area as a part of the first case's; null if that is 0.
    pub relative_area: Option<f64>,
    /// Mean as a part of the first case's; null if that is 0. At one speed, where no area is, this is the comparison.
    pub relative_height: Option<f64>,
    /// How both parts lie to the true ones.
    pub relative_is: Bound,
    /// Per speed whether the height is a lower bound, as nothing fell up to the largest rate tried.
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
    /// Its outline; of a case from a file without scan and border rides.
    pub basin: Basin,
}

impl CompareDocument {
    /// The document of some cases.
    pub fn new(search: ResolvedSearch, cases: &[Case], complete: bool) -> Self {
        let first = cases.first().map_or(0.0, |c| c.basin.area());
        let first_mean = cases.first().and_then(|c| c.basin.mean_height()).unwrap_or(0.0);
        let first_capped = cases.first().is_some_and(|c| c.basin.capped());
        // The first compared with itself is 1, however high it is.
        let relative_is = |case: &Case| match cases.first() {
            Some(first) if first.label == case.label => Bound::Measured,
            _ => Bound::of_ratio(case.basin.capped(), first_capped),
        };
        let speeds = |case: &Case| case.basin.columns.iter().map(|c| c.speed).collect::<Vec<_>>();
        let entry = |case: &Case| CaseEntry {
            label: case.label.clone(),
            config: case.config.clone(),
            speeds: speeds(case),
            upper: case.basin.columns.iter().map(|c| c.upper).collect(),
            area: case.basin.area(),
            mean_height: case.basin.mean_height(),
            relative_area: (first > 0.0).then(|| case.basin.area() / first),
            relative_height: case.basin.mean_height().filter(|_| first_mean > 0.0).map(|m| m / first_mean),
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
            cases: cases.iter().map(entry).collect(),
            rmse: distances(|r| r.mean),
            rmse_as_printed: distances(|r| r.as_printed),
            rmse_is: between(cases, |r| r.bound),
            same_speeds: cases.windows(2).all(|pair| speeds(&pair[0]) == speeds(&pair[1])),
        }
    }

    /// Whether there is a single speed, under whose heights is no area.
    pub fn one_speed(&self) -> bool {
        self.cases.iter().all(|case| case.speeds.len() < 2)
    }
}

/// A measure of the distance of each two cases; of a case from itself it is measured, however high it is.
fn between<T>(cases: &[Case], of: impl Fn(Rmse) -> T) -> Vec<Vec<Option<T>>> {
    let distance = |i: usize, j: usize| {
        let found = rmse(&cases[i].basin, &cases[j].basin)?;
        Some(of(if i == j { Rmse { bound: Bound::Measured, ..found } } else { found }))
    };
    (0..cases.len()).map(|i| (0..cases.len()).map(|j| distance(i, j)).collect()).collect()
}
