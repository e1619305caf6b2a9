//! One table from several.

use super::table::{RiderTable, Row};
use super::{KEYS, MergeError};
use crate::range::within;

/// One table with all rows of `tables`, sorted by speed. A group takes rows up to `tolerance_m_s` \[m/s\] above its
/// slowest row. The tables' own groups, best runs, regressions and remarks are left out.
///
/// # Errors
/// No tables; tables with different gains, delay, neuromuscular dynamics or bicycle; more than 1000 rows; a tolerance
/// outside 0.001 to 10 m/s.
pub fn merge(name: &str, tables: &[RiderTable], tolerance_m_s: f64) -> Result<RiderTable, MergeError> {
    let first = tables.first().ok_or(MergeError::None)?;
    within("tolerance (m/s)", tolerance_m_s, 1e-3, 10.0)?;
    for other in tables {
        agree(first, other)?;
    }
    let mut rows: Vec<Row> = tables.iter().flat_map(|table| table.rows.clone()).collect();
    within("number of `rows`", rows.len() as f64, 1.0, 1000.0)?;
    rows.sort_by(|a, b| a.speed_m_s.total_cmp(&b.speed_m_s));
    let (mut group, mut slowest) = (1, rows[0].speed_m_s);
    for row in &mut rows {
        // The rounding of decimal speeds: 2.1 and 2.4 m/s are together under a tolerance of 0.3 m/s.
        if row.speed_m_s > slowest + tolerance_m_s + 1e-9 {
            (group, slowest) = (group + 1, row.speed_m_s);
        }
        row.group = group;
    }
    let names: Vec<&str> = tables.iter().map(|table| table.name.as_str()).collect();
    Ok(RiderTable {
        name: name.into(),
        source: Some(format!("merged from {}", names.join(", "))),
        note: None,
        best_runs: None,
        regression: None,
        rows,
        ..first.clone()
    })
}

/// What all sets of a table share, as text.
fn shared(table: &RiderTable) -> [(&'static str, String); 4] {
    let gains: Vec<&str> = table.columns.iter().map(|&i| KEYS[i]).collect();
    let muscles = table.neuromuscular;
    [
        ("gains", gains.join(", ")),
        ("delay", format!("{} ms", (table.delay_s * 1e9).round() / 1e6)),
        ("neuromuscular dynamics", format!("{} rad/s, {}", muscles.omega_rad_s, muscles.zeta)),
        ("bicycle", table.bicycle.clone().unwrap_or_else(|| "none".into())),
    ]
}

/// Checks that two tables describe the same kind of rider.
fn agree(first: &RiderTable, other: &RiderTable) -> Result<(), MergeError> {
    let differs = |(a, b): &((_, String), (_, String))| a.1 != b.1;
    match shared(first).into_iter().zip(shared(other)).find(differs) {
        None => Ok(()),
        Some(((what, value), (_, other_value))) => {
            let (first, other) = (first.name.clone(), other.name.clone());
            Err(MergeError::Differs { first, other, what, value, other_value })
        }
    }
}
