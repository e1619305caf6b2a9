//! Document, table and text of `sim-host identify sensor`.

use super::tool::{SCHEMA, Tool};
use crate::plant::Sensor;
use crate::plant::sensor_file::{MeasuredNumber, SensorFile, SensorNumbers, table_of};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;

/// The source of the measured values.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ResolvedSensors {
    /// The recordings.
    pub files: Vec<String>,
    /// The map, by name or file.
    pub map: String,
    /// Column of the distance measured by the wheel.
    pub distance: Option<String>,
}

/// `identify sensor`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct SensorDocument {
    /// 1.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: u32,
    /// The program.
    pub tool: Tool,
    /// The source of the measured values.
    pub config: ResolvedSensors,
    /// The models, by the name of their table in a file for `--sensor`.
    pub sensors: BTreeMap<&'static str, SensorNumbers>,
}

impl SensorDocument {
    /// The document of a file of models.
    pub fn new(config: ResolvedSensors, file: &SensorFile) -> Self {
        let table = |(sensor, numbers): (Sensor, &SensorNumbers)| (table_of(sensor), numbers.clone());
        Self { schema: SCHEMA, tool: Tool::this(), config, sensors: file.tables().map(table).collect() }
    }
}

/// A line of the table.
#[derive(Clone, Debug, Serialize)]
pub struct SensorRow {
    sensor: &'static str,
    number: String,
    axis: String,
    unit: String,
    value: f64,
    low: f64,
    high: f64,
    seconds: f64,
}

/// All measured models; both wheels share one.
fn tables(file: &SensorFile) -> impl Iterator<Item = (&'static str, &SensorNumbers)> {
    file.tables()
        .filter(|(sensor, _)| *sensor != Sensor::FrontWheel)
        .map(|(s, numbers)| (table_of(s), numbers))
}

/// All measured values as rows.
pub fn rows(file: &SensorFile) -> Vec<SensorRow> {
    let row = |sensor, m: &MeasuredNumber| SensorRow {
        sensor,
        number: m.number.clone(),
        axis: m.axis.clone(),
        unit: m.unit.clone(),
        value: m.value,
        low: m.low,
        high: m.high,
        seconds: m.seconds,
    };
    tables(file).flat_map(|(sensor, numbers)| numbers.measured.iter().map(move |m| row(sensor, m))).collect()
}

/// The measured values as text, with what was left out.
pub fn text(file: &SensorFile) -> String {
    let mut text = String::new();
    for (sensor, numbers) in tables(file) {
        let _ = writeln!(text, "{sensor:52} {:>11} {:>25} {:>9}", "value", "95 % interval", "from [s]");
        for m in &numbers.measured {
            let axis = if m.axis.is_empty() { String::new() } else { format!(", {}", m.axis) };
            let what = format!("{}{axis} [{}]", m.number, m.unit);
            let interval = format!("{:.3e} to {:.3e}", m.low, m.high);
            let _ = writeln!(text, "  {what:50} {:11.3e} {interval:>25} {:9.1}", m.value, m.seconds);
        }
        for what in &numbers.left_out {
            let _ = writeln!(text, "  left out: {what}");
        }
        text.push('\n');
    }
    text
}
