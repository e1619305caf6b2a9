//! Flight card: what is noticed of a fault in calm riding, and how soon. The table is that of docs/safety.md.

use rayon::prelude::*;
use sim_host::ride::{Conditions, Start};
use tests::fault_cards::{product, smart};
use tests::noticed::{Noticed, noticed, rows_of};

/// The table's speeds \[m/s\].
const SPEEDS: [f64; 5] = [2.5, 3.0, 3.5, 4.0, 5.0];
/// How the rides begin: steer rate \[rad/s\], and when the fault begins \[s\].
const STARTS: [(f64, f64); 3] = [(0.1, 1.0), (0.5, 1.0), (1.0, 0.1)];
/// How long a ride is \[s\].
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

/// One cell: causes, time from the fault, largest roll angle up to then; whether the bicycle falls.
fn cell(fault: &str, (steer_rate_rad_s, from_s): (f64, f64), speed_m_s: f64) -> String {
    let start = Start { speed_m_s, steer_rate_rad_s, roll_rate_rad_s: 0.0 };
    let conditions = |plant| Conditions { time_limit_s: RIDE_S, ..smart(product(), plant) };
    let Noticed { first, fell, .. } = noticed(&format!("{fault}@{from_s}s"), start, conditions);
    let falls = if fell { ", falls" } else { "" };
    first.map_or(format!("-{falls}"), |first| format!("{first}, {:.2}{falls}", first.roll_rad))
}

/// Situation: the smart old rider with what is flashed, a small knock to the handlebar, and later one thing broken.
/// Action: ride on. Must hold: what is told, how long after the fault and by which roll angle, and who falls, are what
/// the table says.
#[test]
fn calm_riding_shows_what_the_table_says() {
    let cells: Vec<_> = FAULTS.iter().flat_map(|f| STARTS.map(|s| (*f, s))).collect();
    let rows: Vec<String> = cells
        .par_iter()
        .map(|&(fault, start)| {
            let cells = SPEEDS.map(|speed| cell(fault, start, speed));
            format!("| `{fault}` | {} rad/s, {} s | {} |", start.0, start.1, cells.join(" | "))
        })
        .collect();
    // A row in which nothing is ever noticed and nobody falls stands in the list below the table.
    let silent = |row: &&String| row.matches("| -").count() < SPEEDS.len() || row.contains("falls");
    let shown: Vec<&str> = rows.iter().filter(silent).map(String::as_str).collect();
    let found = rows_of(include_str!("../../../docs/safety.md"), "gentle");
    assert!(found == shown, "docs/safety.md should say:\n{}", shown.join("\n"));
}
