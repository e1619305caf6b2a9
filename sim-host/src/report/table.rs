//! CSV tables, headed by `#` lines with the program and the full configuration.

use super::tool::Tool;
use crate::basin::ScanPoint;
use crate::ride::FallCause;
use serde::Serialize;

/// The heading as comment lines: the program, then `config` as one line of JSON.
pub fn heading(config: &impl Serialize) -> String {
    let tool = Tool::this();
    let config = serde_json::to_string(config).unwrap_or_default();
    format!("# {} {} commit {}\n# {config}\n", tool.name, tool.version, tool.commit)
}

/// A writer that quotes values with a `#`, at which comment-aware readers would stop.
fn writer(heading: Vec<u8>) -> csv::Writer<Vec<u8>> {
    csv::WriterBuilder::new().comment(Some(b'#')).from_writer(heading)
}

/// A table of serialisable rows; columns are named by their fields.
///
/// # Errors
/// A row cannot be written as CSV.
pub fn table<R: Serialize>(config: &impl Serialize, rows: &[R]) -> Result<Vec<u8>, csv::Error> {
    let mut writer = writer(heading(config).into_bytes());
    for row in rows {
        writer.serialize(row)?;
    }
    writer.into_inner().map_err(|e| csv::Error::from(std::io::Error::other(e.to_string())))
}

/// A table of rows under `columns`; `None` is an empty cell.
///
/// # Errors
/// The rows differ in length from the heading.
pub fn rows<R: Serialize>(
    config: &impl Serialize,
    columns: &[String],
    rows: impl IntoIterator<Item = R>,
) -> Result<Vec<u8>, csv::Error> {
    let mut writer = writer(heading(config).into_bytes());
    writer.write_record(columns)?;
    for row in rows {
        writer.serialize(row)?;
    }
    writer.into_inner().map_err(|e| csv::Error::from(std::io::Error::other(e.to_string())))
}

/// A table without the heading, as text.
///
/// # Errors
/// A row cannot be written as CSV.
pub fn csv_text<R: Serialize>(rows: &[R]) -> Result<String, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row)?;
    }
    let bytes = writer.into_inner().map_err(|e| csv::Error::from(std::io::Error::other(e.to_string())))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// One line of a basin's table.
#[derive(Clone, Debug, Serialize)]
pub struct BasinRow {
    /// Forward speed.
    pub speed_m_s: f64,
    /// Disturbance.
    pub rate_rad_s: f64,
    /// "fallen", "recovered", "undecided", or "border" for the outline.
    pub outcome: &'static str,
    /// Time to fall; empty if the ride did not fall.
    pub time_to_fall_s: Option<f64>,
    /// Reason of the fall, at the border that of the nearest ride beyond; empty without a fall.
    pub fall: Option<&'static str>,
    /// For a border: whether it is a lower bound because nothing fell up to the largest rate tried.
    pub capped: Option<bool>,
}

/// The quantiles of drawn basins as rows, outcomes `border-5%`, `border-50%` and `border-95%`.
pub fn drawn_rows(speeds: &[f64], drawn: &crate::basin::Drawn) -> Vec<BasinRow> {
    const NAMES: [&str; 3] = ["border-5%", "border-50%", "border-95%"];
    let row = |speed_m_s, (outcome, rate_rad_s)| BasinRow {
        speed_m_s,
        rate_rad_s,
        outcome,
        time_to_fall_s: None,
        fall: None,
        capped: None,
    };
    let of_speed =
        |(&v, quantiles): (&f64, [f64; 3])| NAMES.into_iter().zip(quantiles).map(move |q| row(v, q));
    speeds.iter().zip(drawn.heights()).flat_map(of_speed).collect()
}

/// The scan and, per speed, the border as rows.
pub fn basin_rows(basin: &crate::basin::Basin) -> Vec<BasinRow> {
    let mut rows = Vec::new();
    for c in &basin.columns {
        let row = |rate, outcome, time, fall: Option<FallCause>| BasinRow {
            speed_m_s: c.speed,
            rate_rad_s: rate,
            outcome,
            time_to_fall_s: time,
            fall: fall.map(FallCause::name),
            capped: None,
        };
        rows.push(BasinRow { capped: Some(c.capped), ..row(c.upper, "border", None, c.beyond) });
        rows.extend(c.scan.iter().map(|ScanPoint { rate, outcome }| {
            row(*rate, outcome.name(), outcome.time_to_fall_s(), outcome.fall())
        }));
    }
    rows
}
