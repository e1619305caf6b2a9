//! Flight card: what is noticed of a fault in calm riding, and how soon. The table is that of docs/safety.md.

use control::{Cause, Causes};
use rayon::prelude::*;
use sim_host::plant::{Fault, Plant};
use sim_host::ride::{Conditions, Start, TracePoint, traced};
use tests::fault_cards::{product, smart};

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

/// Told of the fault, and of nothing that follows from how the bicycle moves.
fn of_the_fault(p: &TracePoint) -> Vec<Cause> {
    let position = [Cause::Fallen, Cause::Parked, Cause::RollUnknown];
    Causes(p.causes).iter().filter(|cause| !position.contains(cause)).collect()
}

/// One cell: causes, time from the fault, largest roll angle up to then; whether the bicycle falls.
fn cell(fault: &str, (steer_rate_rad_s, from_s): (f64, f64), speed_m_s: f64) -> String {
    let fault: Fault = format!("{fault}@{from_s}s").parse().unwrap_or_else(|e| panic!("{fault}: {e}"));
    let plant = Plant { faults: vec![fault], ..Plant::default() };
    let conditions = Conditions { time_limit_s: RIDE_S, ..smart(product(), plant) };
    let start = Start { speed_m_s, steer_rate_rad_s, roll_rate_rad_s: 0.0 };
    let (ride, trace) = traced(&conditions, start);
    let told = trace.iter().position(|p| !of_the_fault(p).is_empty());
    let falls = if ride.fell() { ", falls" } else { "" };
    let Some(told) = told else { return format!("-{falls}") };
    let roll_rad = trace[..=told].iter().filter(|p| p.t > from_s).map(|p| p.roll.abs()).fold(0.0, f64::max);
    let causes: Vec<String> = of_the_fault(&trace[told]).iter().map(|c| c.code().to_string()).collect();
    format!("{}: {:.2} s, {roll_rad:.2}{falls}", causes.join(" "), trace[told].t - from_s)
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
    let page = include_str!("../../../docs/safety.md");
    let found = page.split_once("<!-- gentle -->\n").and_then(|(_, rest)| rest.split_once("\n<!-- end -->"));
    let (found, _) = found.expect("docs/safety.md has the table");
    let found: Vec<&str> = found.lines().skip(2).collect();
    assert!(found == shown, "docs/safety.md should say:\n{}", shown.join("\n"));
}
