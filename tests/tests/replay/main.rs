//! Recorded rides through the flashed code.
#![cfg(unix)]

mod bad_input;
mod bad_maps;
mod extracts;
mod faults;
mod frames;
mod many;
mod maps;
mod missing;
mod monitor;
mod noise;
mod recorded;
mod resample;

use control::{Config, Plan};
use serde_json::Value;
use sim_host::plant::{Measured, Sensor};
use sim_host::recording::{Remark, table};
use sim_host::replay::{Feed, FeedOptions, Map, Resample, Sample, Samples, samples};
use std::f64::consts::TAU;
use std::fmt::Write;
use tests::cli::Bench;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");
/// A control period \[s\].
const PERIOD_S: f64 = 1e-3;
/// The columns of [`rows`].
const HEADER: &str = "t,gx,gy,gz,ax,ay,az,steer,steer_rate,front,rear";
/// Gyro and rear wheel of [`HEADER`].
const SMALLEST: &str =
    "[time]\ncolumn = 't'\n[gyro]\ncolumns = ['gx', 'gy', 'gz']\n[rear_wheel]\ncolumns = ['rear']\n";

/// A gentle ride at 4 m/s, 200 rows a second, whose sensors are consistent and have some noise; the columns of
/// [`HEADER`].
fn rows(count: usize) -> Vec<[f64; 11]> {
    let omega = TAU * 0.8;
    let noise = |i: usize, factor: f64| ((i * i) as f64 * factor).sin();
    let row = |i: usize| {
        let t = 0.005 * i as f64;
        let (sine, cosine) = (omega * t).sin_cos();
        let (roll, steer) = (0.05 * sine / omega, 0.02 * sine);
        [
            t,
            0.05 * cosine + 0.002 * noise(i, 1.1),
            0.002 * noise(i, 0.3),
            4.0 * (steer * 0.3175_f64.cos()).tan() / 1.0638 + 0.002 * noise(i, 0.7),
            0.1 * noise(i, 0.37),
            -9.81 * roll.sin() + 0.05 * noise(i, 1.7),
            -9.81 * roll.cos() + 0.05 * noise(i, 0.11),
            steer,
            0.02 * omega * cosine,
            4.0 + 0.001 * (i % 7) as f64,
            4.0 + 0.001 * (i % 5) as f64,
        ]
    };
    (0..count).map(row).collect()
}

/// Rows as lines of text.
fn lines(rows: &[[f64; 11]]) -> Vec<String> {
    rows.iter().map(|row| row.map(|x| x.to_string()).join(",")).collect()
}

/// A table: a header, lines, a line feed after each.
fn table_of(header: &str, lines: &[String]) -> String {
    let mut text = format!("{header}\n");
    for line in lines {
        let _ = writeln!(text, "{line}");
    }
    text
}

/// The samples of a table by a map.
fn sampled(text: &str, map: &str) -> Result<Samples, Remark> {
    let map = Map::parse(map).unwrap_or_else(|error| panic!("{error}"));
    samples(&table::parse(text)?, &map, PERIOD_S)
}

/// A sensor's samples in a table.
fn track(text: &str, map: &str, sensor: Sensor) -> Vec<Sample> {
    let samples = sampled(text, map).unwrap_or_else(|error| panic!("{error}"));
    samples.track(sensor).unwrap_or_else(|| panic!("no {}", sensor.name())).samples.clone()
}

/// The controller's measurements at each instant, before any fault.
fn fed(samples: &Samples, resample: Resample, longest_gap_s: f64) -> Vec<Measured> {
    let options = FeedOptions { period_s: PERIOD_S, resample, longest_gap_s, faults: &[], seed: 0 };
    let mut feed = Feed::new(samples, options).unwrap();
    std::iter::from_fn(|| feed.next(false)).map(|(_, input)| input).collect()
}

/// The product's plan, ready for torque.
fn product() -> Plan {
    let mut config = Config::product();
    config.calibration.polarity_checked = true;
    config.plan().unwrap()
}

/// All remarks of a document.
fn remarks(document: &Value) -> Vec<&str> {
    document["remarks"].as_array().unwrap().iter().map(|remark| remark.as_str().unwrap()).collect()
}

/// A cause of a document by its number.
fn cause(document: &Value, number: u64) -> Option<&Value> {
    document["causes"].as_array().unwrap().iter().find(|cause| cause["number"] == number)
}

/// A number of a document.
fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// A bench with the gentle ride as `ride.csv`.
fn bench(count: usize) -> Bench {
    let bench = Bench::new(PROGRAM);
    bench.write("ride.csv", table_of(HEADER, &lines(&rows(count))));
    bench
}
