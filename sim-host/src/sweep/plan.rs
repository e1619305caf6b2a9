//! The plan of a sweep: identifies the sweep and its cells, so that parts can be combined.

use super::Axis;
use super::seal::hash;
use crate::basin::{Method, Search};
use crate::report::resolved::axis_name;
use crate::report::tool::{SCHEMA, Tool};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Name of the plan's file.
pub const PLAN: &str = "plan.json";

/// Settings of the basin search in every cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SweepSearch {
    /// Forward speeds \[m/s\].
    pub speeds: Vec<f64>,
    /// "steer-rate" or "roll-rate".
    pub axis: String,
    /// Largest disturbance tried \[rad/s\].
    pub max_rate: f64,
    /// Step of the scan \[rad/s\].
    pub scan_step: f64,
    /// Tolerance of the borders \[rad/s\].
    pub tolerance: f64,
    /// How the rides are simulated.
    #[serde(default)]
    pub method: Method,
}

/// Plan of a sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Schema version of the file.
    pub schema: u32,
    /// The program and its version.
    pub tool: Tool,
    /// Options common to all cells, as on the command line.
    pub options: Vec<String>,
    /// Search in every cell.
    pub search: SweepSearch,
    /// Axes in which the cells differ.
    pub axes: Vec<Axis>,
    /// Identities of the cells, with the last axis varying fastest.
    pub cells: Vec<String>,
}

impl SweepSearch {
    /// The search as it is written to files.
    pub fn new(search: &Search) -> Self {
        Self {
            speeds: search.speeds.clone(),
            axis: axis_name(search.axis).into(),
            max_rate: search.max_rate,
            scan_step: search.scan_step,
            tolerance: search.tolerance,
            method: search.method,
        }
    }
}

impl Plan {
    /// Plan of a sweep whose cells have these configurations. A cell's identity is the hash of program,
    /// options, configuration and search, which together determine its result.
    pub fn new(options: Vec<String>, axes: Vec<Axis>, search: &Search, configs: &[Value]) -> Self {
        let (tool, search) = (Tool::this(), SweepSearch::new(search));
        let identity = |(i, config): (usize, &Value)| {
            let values = label(&axes, &combination(&axes, i));
            hash(&(SCHEMA, &tool, &options, values, config, &search))[..24].to_owned()
        };
        let cells = configs.iter().enumerate().map(identity).collect();
        Self { schema: SCHEMA, tool, options, search, axes, cells }
    }

    /// Values of cell `i`, one per axis.
    pub fn values(&self, i: usize) -> Vec<String> {
        combination(&self.axes, i)
    }

    /// Values of cell `i` with their keys: "law=h, torque-limit=2".
    pub fn label(&self, i: usize) -> String {
        label(&self.axes, &self.values(i))
    }

    /// The first part in which `other` differs, as a clause; `None` if equal.
    pub fn difference(&self, other: &Plan) -> Option<&'static str> {
        let differences = [
            (self.schema != other.schema || self.tool != other.tool, "the program differs"),
            (self.options != other.options, "the options differ"),
            (self.axes != other.axes, "the axes (--over) differ"),
            (self.search != other.search, "the search differs"),
            (self.cells != other.cells, "a file that it reads differs"),
        ];
        differences.into_iter().find_map(|(differs, what)| differs.then_some(what))
    }
}

/// Number of cells of the axes.
pub fn count(axes: &[Axis]) -> usize {
    axes.iter().fold(1, |n, axis| n.saturating_mul(axis.values.len()))
}

/// Values of cell `i`, with the last axis varying fastest.
pub fn combination(axes: &[Axis], mut i: usize) -> Vec<String> {
    let mut values: Vec<String> = Vec::with_capacity(axes.len());
    for axis in axes.iter().rev() {
        values.push(axis.values[i % axis.values.len()].clone());
        i /= axis.values.len();
    }
    values.reverse();
    values
}

/// Values with their keys, as text.
pub fn label(axes: &[Axis], values: &[String]) -> String {
    let pairs: Vec<String> = axes.iter().zip(values).map(|(a, v)| format!("{}={v}", a.key)).collect();
    pairs.join(", ")
}
