//! The document of `basin compare`.

use super::document::SCHEMA;
use super::resolved::{ResolvedSearch, Tool};
use crate::basin::{Basin, rmse};
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
        let entry = |case: &Case| CaseEntry {
            label: case.label.clone(),
            config: case.config.clone(),
            speeds: case.basin.columns.iter().map(|c| c.speed).collect(),
            upper: case.basin.columns.iter().map(|c| c.upper).collect(),
            area: case.basin.area(),
            mean_height: case.basin.mean_height(),
            relative_area: (first > 0.0).then(|| case.basin.area() / first),
        };
        let distances = |of: fn(crate::basin::Rmse) -> f64| {
            let row = |a: &Case| cases.iter().map(|b| rmse(&a.basin, &b.basin).map(of)).collect();
            cases.iter().map(row).collect()
        };
        Self {
            schema: SCHEMA,
            tool: Tool::this(),
            search,
            complete,
            cases: cases.iter().map(entry).collect(),
            rmse: distances(|r| r.mean),
            rmse_as_printed: distances(|r| r.as_printed),
        }
    }
}
