//! Detection of faults with fewer sensors. The tables are those of docs/sensors.md.

use control::{Config, Mode};
use rayon::prelude::*;
use sim_host::basin::basin;
use sim_host::parameters::set;
use sim_host::ride::{Conditions, ScheduleSpeed, Start};
use tests::basins::{configured, search};
use tests::detection::{Detection, detect, of_the_fault, rows_of};
use tests::fault_reactions::{product, smart};

const PAGE: &str = include_str!("../../../docs/sensors.md");
/// The faults of the table's last columns.
const FAULTS: [&str; 4] = ["gyro:flip", "gyro.x:flip", "gyro:stuck", "motor:flip"];
/// The table's speeds \[m/s\].
const SPEEDS: [f64; 2] = [3.0, 4.0];

/// A row of the table of sensor sets.
struct Row<'a> {
    cells: Vec<&'a str>,
    config: Config,
}

/// The flashed configuration with the options of a text, as `--set input.motor.fitted=off`.
fn with(options: &str, mut config: Config) -> Config {
    let settings = options.split("--set ").skip(1);
    for setting in settings.map(|s| s.split(['`', ' ']).next().unwrap_or(s)) {
        let (key, value) = setting.split_once('=').unwrap_or_else(|| panic!("{setting} is no setting"));
        set(&mut config, key, value).unwrap_or_else(|e| panic!("{e}"));
    }
    config
}

/// The table's rows, each with its configuration.
fn rows() -> Vec<Row<'static>> {
    let mut rows: Vec<Row> = Vec::new();
    for line in rows_of(PAGE, "sets") {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        let from = match rows.last() {
            Some(before) if cells[1].starts_with("the same and") => before.config.clone(),
            _ => product(),
        };
        rows.push(Row { config: with(cells[1], from), cells });
    }
    assert_eq!(rows.len(), 12);
    rows
}

/// The speed that schedules the rider's gains, and the law's where no other sensor is fitted: that of the only wheel
/// if one is missing.
fn schedule(config: &Config) -> ScheduleSpeed {
    if config.input.front_wheel.fitted { ScheduleSpeed::Front } else { ScheduleSpeed::Rear }
}

fn ridden(config: &Config, fault: &str, speed_m_s: f64, time_limit_s: f64) -> Detection {
    let start = Start { speed_m_s, steer_rate_rad_s: 1.0, roll_rate_rad_s: 0.0 };
    let schedule_speed = schedule(config);
    detect(fault, start, |plant| Conditions { time_limit_s, schedule_speed, ..smart(config.clone(), plant) })
}

/// One cell: at both speeds the causes and the time from the fault, and whether the bicycle falls; once where they
/// agree.
fn cell(config: &Config, fault: &str) -> String {
    let one = |speed| {
        let Detection { first, fell, .. } = ridden(config, &format!("{fault}@100ms"), speed, 10.0);
        match (first, fell) {
            (None, false) => "-".into(),
            (None, true) => "falls".into(),
            (Some(first), fell) => format!("{first}{}", if fell { ", falls" } else { "" }),
        }
    };
    let [slow, fast] = SPEEDS.map(one);
    if slow == fast { slow } else { format!("{slow} / {fast}") }
}

/// Situation: the smart old rider with each set of sensors of the table, a knock to the handlebar, one fault.
/// Action: ride on.
/// Must hold: the causes, their time after the fault, and the falls are those of the table.
#[test]
fn detection_with_each_set_is_as_documented() {
    let rows = rows();
    let should: Vec<String> = rows
        .par_iter()
        .map(|row| {
            let detected: Vec<String> = FAULTS.par_iter().map(|fault| cell(&row.config, fault)).collect();
            format!("| {} | {} |", row.cells[..3].join(" | "), detected.join(" | "))
        })
        .collect();
    assert!(rows_of(PAGE, "sets") == should, "docs/sensors.md should have:\n{}", should.join("\n"));
}

/// Situation: the bicycle without a rider with each set of sensors of the table.
/// Action: find the basins over 1 to 7 m/s.
/// Must hold: their areas relative to that of the whole set are those of the table.
#[test]
#[ignore = "slow: cargo xtask test --all"]
fn each_set_has_the_basin_of_the_table() {
    let speeds: Vec<f64> = (0..=12).map(|i| 1.0 + 0.5 * f64::from(i)).collect();
    let area = |config: &Config| {
        let conditions = Conditions { schedule_speed: schedule(config), ..configured(config.clone()) };
        let found = basin(&conditions, &search(&speeds, 30.0), |_| (), || false);
        found.unwrap_or_else(|e| panic!("{e}")).area()
    };
    let rows = rows();
    let areas: Vec<f64> = rows.par_iter().map(|row| area(&row.config)).collect();
    assert!(areas[0] > 10.0, "{areas:?}");
    let output: Vec<&str> = rows.iter().map(|row| row.cells[2]).collect();
    let should: Vec<String> = areas.iter().map(|a| format!("{:.0} %", 100.0 * a / areas[0])).collect();
    assert_eq!(output, should);
}

/// Situation: the whole set, and for the only wheel that with the rear one alone, at 4 m/s after a knock.
/// Action: each sensor stops sending.
/// Must hold: cause, time and reaction are those of the table.
#[test]
fn reactions_to_a_lost_sensor_are_as_documented() {
    const REAR: &str = "--set input.front_wheel.fitted=off --set input.wheel=rear";
    let cases = [
        ("gyro", "gyro", ""),
        ("accelerometer", "accel", ""),
        ("steer angle", "steer", ""),
        ("steer rate", "steer-rate", ""),
        ("one wheel of two", "front-wheel", ""),
        ("one wheel of two", "rear-wheel", ""),
        ("the only wheel", "rear-wheel", REAR),
        ("drive's report", "motor-report", ""),
    ];
    let rows = rows_of(PAGE, "lost");
    for (name, sensor, options) in cases {
        let Detection { first, trace, .. } =
            ridden(&with(options, product()), &format!("{sensor}:missing@300ms"), 4.0, 1.0);
        let first = first.unwrap_or_else(|| panic!("{name} is not detected"));
        let after_ms = (1e3 * first.after_s).round();
        let code = first.causes[0].code();
        let mode = trace.iter().find(|p| !of_the_fault(p).is_empty()).map(|p| p.mode);
        let mode = if mode == Some(Mode::Fault as u8) { "fault" } else { "limp" };
        let row = rows.iter().find(|row| row.starts_with(&format!("| {name} |")));
        let row = row.unwrap_or_else(|| panic!("no row {name}"));
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let reported = cells[2].starts_with(&format!("{code} after"))
            || cells[2].starts_with("17 or 21") && [17, 21].contains(&code);
        assert!(
            reported && cells[2].ends_with(&format!("after {after_ms} ms")),
            "{code} after {after_ms} ms: {row}"
        );
        assert!(cells[3].starts_with(mode), "{mode}: {row}");
    }
    assert_eq!(rows.len(), 7);
}
