//! JSON document and CSV tables of `sweep`.

use super::axis::AxisUnit;
use super::names::variable;
use super::{Axis, Found, Grid, SweepSearch, Unit};
use crate::basin::Work;
use crate::report::table;
use crate::report::tool::{SCHEMA, Tool};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Map, Value};

/// `sweep`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct SweepDocument {
    /// 1.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: u32,
    /// The program.
    pub tool: Tool,
    /// The options that all cells share, as on the command line.
    pub options: Vec<String>,
    /// The search of each cell's basin.
    pub search: SweepSearch,
    /// The conditions that differ between cells.
    pub axes: Vec<Axis>,
    /// False while cells are missing.
    pub complete: bool,
    /// The configuration entries that all cells share, as in the document of `basin`.
    pub config: Value,
    /// The finished cells; the values of the last axis vary fastest.
    pub cells: Vec<CellDocument>,
    /// Amount of computation.
    pub work: Work,
}

/// One cell.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct CellDocument {
    /// Its identifier, which is the name of its file.
    pub id: String,
    /// The axes' values.
    pub values: Vec<String>,
    /// The configuration entries that differ between cells.
    pub config: Value,
    /// The scenario that gives this cell again: see `basin --scenario`.
    pub scenario: Value,
    /// Area under the heights, trapezoidal rule \[rad m/s^2\]; null at a single speed.
    pub area: Option<f64>,
    /// Mean height \[rad/s\].
    pub mean_height: f64,
    /// Whether area and mean are lower bounds because a height is one.
    pub area_capped: bool,
    /// Largest torque of the rides at the border \[N m\].
    pub peak_torque_nm: f64,
    /// Largest change of torque of the rides at the border \[N m/s\].
    pub peak_slew_nm_s: f64,
    /// Result for each speed of the search.
    pub found: Vec<Found>,
}

impl SweepDocument {
    /// The document of a complete or partial sweep.
    pub fn new(grid: &Grid) -> Self {
        let plan = &grid.plan;
        let shared = shared(grid);
        let entry = |(i, unit): (usize, &Unit)| {
            let (peak_torque_nm, peak_slew_nm_s) = unit.most();
            CellDocument {
                id: unit.id.clone(),
                values: plan.values(i),
                config: without(&unit.config, &shared),
                scenario: unit.scenario.clone(),
                area: grid.area(unit),
                mean_height: unit.mean_height(),
                area_capped: unit.capped(),
                peak_torque_nm,
                peak_slew_nm_s,
                found: unit.found.clone(),
            }
        };
        Self {
            schema: SCHEMA,
            tool: plan.tool.clone(),
            options: plan.options.clone(),
            search: plan.search.clone(),
            axes: plan.axes.clone(),
            complete: grid.missing() == 0,
            config: shared.clone().into(),
            cells: done(grid).map(entry).collect(),
            work: done(grid).fold(Work::default(), |sum, (_, u)| sum.plus(&u.work)),
        }
    }

    /// Heading of tables and figures: everything except the cells. The program is the one that computed the cells,
    /// which can differ from the one that writes.
    pub fn heading(&self) -> Value {
        let Self { tool, options, search, axes, complete, config, .. } = self;
        serde_json::json!({"tool": tool, "options": options, "search": search, "axes": axes, "config": config, "complete": complete})
    }
}

fn done(grid: &Grid) -> impl Iterator<Item = (usize, &Unit)> {
    grid.units.iter().enumerate().filter_map(|(i, unit)| Some((i, unit.as_ref()?)))
}

/// The entries that are equal in all configurations.
fn shared(grid: &Grid) -> Map<String, Value> {
    let mut units = done(grid).map(|(_, unit)| &unit.config);
    let Some(Value::Object(first)) = units.next() else { return Map::new() };
    let mut shared = first.clone();
    for config in units {
        shared.retain(|key, value| config.get(key) == Some(value));
    }
    shared
}

fn without(config: &Value, shared: &Map<String, Value>) -> Value {
    let all = config.as_object().into_iter().flatten();
    let own = all.filter(|(key, _)| !shared.contains_key(*key));
    own.map(|(key, value)| (key.clone(), value.clone())).collect::<Map<_, _>>().into()
}

/// CSV table with one line per cell: the axes' values, then measures of the basin.
///
/// # Errors
/// A row cannot be written as CSV.
pub fn cells_table(document: &SweepDocument) -> Result<Vec<u8>, csv::Error> {
    let measures = ["area_rad_m_s2", "mean_height_rad_s", "peak_torque_nm", "peak_slew_nm_s", "area_capped"];
    let rows = document.cells.iter().map(|cell| {
        let numbers = [Some(cell.mean_height), Some(cell.peak_torque_nm), Some(cell.peak_slew_nm_s)];
        let number = |x: Option<f64>| x.map_or(String::new(), |x| x.to_string());
        let measures =
            [cell.area].into_iter().chain(numbers).map(number).chain([cell.area_capped.to_string()]);
        values(document, cell).chain(measures).collect::<Vec<_>>()
    });
    table::rows(&document.heading(), &columns(document, &measures), rows)
}

/// CSV table with one line per cell and speed: the axes' values, the speed, the result.
///
/// # Errors
/// A row cannot be written as CSV.
pub fn heights_table(document: &SweepDocument) -> Result<Vec<u8>, csv::Error> {
    let measures = ["speed_m_s", "height_rad_s", "capped", "peak_torque_nm", "peak_slew_nm_s", "fall"];
    let speeds = &document.search.speeds;
    let rows = document.cells.iter().flat_map(|cell| {
        cell.found.iter().zip(speeds).map(|(found, speed)| {
            let effort = |of: fn(&crate::ride::Effort) -> f64| {
                found.effort.as_ref().map_or(String::new(), |e| of(e).to_string())
            };
            let Found { height, capped, fall, .. } = found;
            let measures = [
                speed.to_string(),
                height.to_string(),
                capped.to_string(),
                effort(|e| e.peak_torque_nm),
                effort(|e| e.peak_slew_nm_s),
                fall.clone().unwrap_or_default(),
            ];
            values(document, cell).chain(measures).collect::<Vec<_>>()
        })
    });
    table::rows(&document.heading(), &columns(document, &measures), rows)
}

/// Names of the columns: an axis of numbers ends with its unit.
fn columns(document: &SweepDocument, measures: &[&str]) -> Vec<String> {
    let name = |axis: &Axis| match axis.unit() {
        Some(AxisUnit { column, .. }) if !column.is_empty() => format!("{}_{column}", variable(axis)),
        _ => variable(axis),
    };
    document.axes.iter().map(name).chain(measures.iter().map(|m| (*m).to_owned())).collect()
}

/// The axes' values of a cell, numbers without their unit.
fn values<'a>(document: &'a SweepDocument, cell: &'a CellDocument) -> impl Iterator<Item = String> + 'a {
    document
        .axes
        .iter()
        .zip(&cell.values)
        .map(|(axis, value)| axis.number_of(value).map_or_else(|| value.clone(), |x| x.to_string()))
}
