//! `sim-host record`.

use serde_json::{Value, json};
use tests::cli::{Bench, repository};
use tests::json_schema::violations;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");
const NOISY: &str = "record --speed 5 --duration 10 --remnant 0.5 --steer-noise 0.001 --treadmill-drift 0.1";

/// Columns and lines of a record.
fn table(text: &str) -> (Vec<&str>, Vec<Vec<f64>>) {
    let mut lines = text.lines();
    let header = lines.next().expect("a header").split(',').collect();
    let numbers = |line: &str| line.split(',').map(|cell| cell.parse().expect("a number")).collect();
    (header, lines.map(numbers).collect())
}

/// Situation: a record to standard output and to a file, with and without torque pulses. Must hold: the documented columns in
/// their order, no comments, a line each 5 ms; both places get the same; a document that fits its schema.
#[test]
fn a_record_has_its_columns_and_its_document() {
    let bench = Bench::new(PROGRAM);
    let run = bench.run("record --rider young --speed 5 --duration 10");
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    let (header, rows) = table(&run.stdout);
    let columns = ["time_s", "lateral_force_n", "steer_rad", "roll_rad", "roll_rate_rad_s", "speed_m_s"];
    assert_eq!(header, columns);
    assert!(rows.len() == 2000 && rows.iter().enumerate().all(|(i, row)| row[0] == i as f64 / 200.0));
    assert!(rows.iter().any(|row| row[1].abs() == 40.0) && rows.iter().any(|row| row[3].abs() > 0.005));

    let line = "record --rider young --speed 5 --duration 10 --steer-pulse 1 --out torque.csv";
    let document = bench.json(line);
    let torque = bench.read("torque.csv");
    let (header, rows) = table(&torque);
    assert_eq!(header[2], "steer_torque_nm");
    assert!(header.len() == 7 && rows.iter().any(|row| row[2].abs() == 1.0));
    let schema = std::fs::read_to_string(repository("docs/schema/record.json")).expect("a schema");
    let committed: Value = serde_json::from_str(&schema).expect("JSON");
    assert_eq!(violations(&committed, &document), [""; 0]);
    assert!(
        bench.run("schema record").stdout == schema,
        "run: sim-host schema record > docs/schema/record.json"
    );
    assert_eq!(document["experiment"]["point"], json!({"ahead_m": 0.1984375, "height_m": 0.942975}));
    assert_eq!((&document["samples"], &document["fall"]), (&json!(2000), &Value::Null));
    assert!(document["gains"]["gains"]["K_phi_d"].as_f64().is_some_and(|gain| gain != 0.0));
    let text = bench.run(line).stdout;
    assert!(text.contains("2000 samples at 200 Hz") && text.contains("of 40 N"), "{text}");
}

/// Situation: a record with noise of every kind. Action: again, with another seed, with another rider. Must hold: the same bytes;
/// other pulses and motion; the same pulses and another motion.
#[test]
fn a_seed_stands_for_one_record() {
    let bench = Bench::new(PROGRAM);
    let run = |more: &str| bench.run(&format!("{NOISY} {more}")).stdout;
    let (first, again, other, rider) =
        (run("--rider young"), run("--rider young"), run("--rider young --seed 1"), run("--rider smart"));
    assert!(first == again && first.lines().count() == 2001);
    let column = |text: &str, at: usize| -> Vec<f64> { table(text).1.iter().map(|row| row[at]).collect() };
    assert!(column(&first, 1) != column(&other, 1) && column(&first, 2) != column(&other, 2));
    assert!(column(&first, 1) == column(&rider, 1) && column(&first, 2) != column(&rider, 2));
}

/// Situation: pushes too strong. Must hold: exit code 1 with the time, no file; with --until-fall the record up to then.
#[test]
fn a_fall_is_an_error_with_its_time() {
    let bench = Bench::new(PROGRAM);
    let line = "record --rider young --speed 5 --pulse 800 --out fallen.csv --json fallen.json";
    bench.run(line).rejected_naming(&["fell after", " s"]);
    assert_eq!(bench.files(), [""; 0]);
    let run = bench.run(&format!("{line} --until-fall"));
    assert!(run.code == Some(0) && run.stdout.contains("up to a fall at"), "{run:?}");
    let document: Value = serde_json::from_str(&bench.read("fallen.json")).expect("JSON");
    let time_s = document["time_to_fall_s"].as_f64().expect("a fall");
    let last = table(&bench.read("fallen.csv")).1.last().expect("lines")[0];
    assert!((time_s - 0.005..=time_s).contains(&last) && (0.5..30.0).contains(&time_s), "{time_s} {last}");
}

/// Situation: values out of range, two outputs in one place, a place that cannot be written to. Must hold: exit code 1, the
/// value and its range or the place named; a wrong form is wrong usage.
#[test]
fn wrong_values_are_named() {
    let bench = Bench::new(PROGRAM);
    for (options, named) in [
        ("--speed 0", &["speed (m/s) = 0", "0.1 to 30"][..]),
        ("--speed nan", &["speed (m/s) = NaN"]),
        ("--speed 5 --rate 5", &["sample rate (Hz) = 5"]),
        ("--speed 5 --duration 1e9", &["duration (s)"]),
        ("--speed 5 --pulse -1", &["lateral force (N) = -1"]),
        ("--speed 5 --force-at 0,-1", &["height above the ground"]),
        ("--speed 5 --treadmill-drift 3", &["drift of the speed"]),
        ("--speed 5 --delay 12.3456ms", &["12.3456 ms", "5 ms from sample to sample"]),
        ("--speed 5 --json", &["--json and --out"]),
        ("--speed 5 --out missing/r.csv", &["missing"]),
        ("--speed 5 --bicycle missing.toml", &["missing.toml"]),
    ] {
        bench.run(&format!("record --rider young {options}")).rejected_naming(named);
    }
    for options in ["", "--speed 5 --force-at 3", "--speed 5 --gains worst"] {
        assert_eq!(bench.run(&format!("record --rider young {options}")).code, Some(2), "{options}");
    }
}
