//! Detection of a fault in calm riding, and its time. The table is that of docs/safety.md.

use rayon::prelude::*;
use sim_host::ride::{Conditions, Start};
use tests::detection::{Detection, detect, rows_of};
use tests::fault_reactions::{product, smart};

/// The table's speeds \[m/s\].
const SPEEDS: [f64; 5] = [2.5, 3.0, 3.5, 4.0, 5.0];
/// Start of the rides: steer rate \[rad/s\], and beginning of the fault \[s\].
const STARTS: [(f64, f64); 3] = [(0.1, 1.0), (0.5, 1.0), (1.0, 0.1)];
/// Duration of a ride \[s\].
const RIDE_S: f64 = 8.0;
const FAULTS: [&str; 17] = [
    "gyro:flip",
    "gyro.x:flip",
    "gyro.z:flip",
    "gyro:stuck",
    "accel:flip",
    "accel:stuck",
    "steer:flip",
    "steer:stuck",
    "steer-rate:flip",
    "steer-rate:stuck",
    "front-wheel:stuck",
    "rear-wheel:stuck",
    "motor:flip",
    "motor:dead",
    "motor:stuck",
    "motor-report:flip",
    "motor-report:stuck",
];

/// One cell: causes, time from the fault, largest roll angle until then; whether the bicycle falls.
fn cell(fault: &str, (steer_rate_rad_s, from_s): (f64, f64), speed_m_s: f64) -> String {
    let start = Start { speed_m_s, steer_rate_rad_s, roll_rate_rad_s: 0.0 };
    let conditions = |plant| Conditions { time_limit_s: RIDE_S, ..smart(product(), plant) };
    let Detection { first, fell, .. } = detect(&format!("{fault}@{from_s}s"), start, conditions);
    let falls = if fell { ", falls" } else { "" };
    first.map_or(format!("-{falls}"), |first| format!("{first}, {:.2}{falls}", first.roll_rad))
}

/// Situation: the smart old rider with the flashed configuration, a small knock to the handlebar, and later one
/// fault.
/// Action: ride on.
/// Must hold: the causes, their time after the fault, the roll angle until then, and the falls are those of the
/// table.
#[test]
fn detection_in_calm_riding_is_as_documented() {
    let cells: Vec<_> = FAULTS.iter().flat_map(|f| STARTS.map(|s| (*f, s))).collect();
    let rows: Vec<String> = cells
        .par_iter()
        .map(|&(fault, start)| {
            let cells = SPEEDS.map(|speed| cell(fault, start, speed));
            format!("| `{fault}` | {} rad/s, {} s | {} |", start.0, start.1, cells.join(" | "))
        })
        .collect();
    // A row without any cause or fall belongs to the list below the table.
    let silent = |row: &&String| row.matches("| -").count() < SPEEDS.len() || row.contains("falls");
    let documented: Vec<&str> = rows.iter().filter(silent).map(String::as_str).collect();
    let found = rows_of(include_str!("../../../docs/safety.md"), "gentle");
    assert!(found == documented, "docs/safety.md should have:\n{}", documented.join("\n"));
}
