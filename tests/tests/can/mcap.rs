//! MCAP files of rides and monitors, read by the package of MCAP's authors.

use super::monitor::broadcast;
use serde_json::Value;
use std::ffi::OsStr;
use std::path::Path;
use tests::cli::Bench;
use tests::python;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

/// What the package reads: topic, schema, metadata, and for each message its time \[ns\] and its row.
fn read(python: &Path, path: &Path, more: &[&str]) -> Value {
    let arguments: Vec<&OsStr> = [path.as_os_str()].into_iter().chain(more.iter().map(OsStr::new)).collect();
    serde_json::from_str(&python::checked(python, "mcap_rows.py", &arguments)).expect("JSON")
}

/// Checks that the messages are the rows of a table: the same numbers under the same names, empty cells without a key.
fn is_table(mcap: &Value, table: &str, start_s: f64) {
    let mut lines = table.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = lines.next().expect("a heading").split(',').collect();
    let lines: Vec<&str> = lines.collect();
    let messages = mcap["messages"].as_array().expect("messages");
    assert_eq!(messages.len(), lines.len());
    let properties = &mcap["schema"]["properties"];
    for (message, line) in messages.iter().zip(lines) {
        let (time_ns, row) = (&message["log_time"], message["row"].as_object().expect("a row"));
        let cells: Vec<&str> = line.split(',').collect();
        let t: f64 = cells[0].parse().expect("a time");
        assert!((time_ns.as_f64().expect("a time") * 1e-9 - start_s - t).abs() < 1e-6, "{time_ns} {t}");
        assert_eq!(
            row.len(),
            cells.iter().filter(|cell| !cell.is_empty() && **cell != "NaN").count(),
            "{line}"
        );
        for (name, cell) in names.iter().zip(cells).filter(|(name, _)| row.contains_key(**name)) {
            let (value, word) = (&row[*name], properties[*name]["type"].as_str().expect("one word"));
            match value {
                Value::Bool(value) => assert_eq!((value.to_string().as_str(), word), (cell, "boolean")),
                Value::Number(number) => {
                    assert!(
                        number.to_string() == cell || number.as_f64() == cell.parse().ok(),
                        "{name}: {cell}"
                    );
                    assert_eq!(word, if number.is_f64() { "number" } else { "integer" }, "{name}");
                }
                other => panic!("{name}: {other}"),
            }
        }
    }
}

/// Situation: a ride. Action: write it as table and as MCAP, read the latter with the package `mcap`.
/// Must hold: the rows of the table, at their times; a type and a unit for every column; program and configuration.
#[test]
fn a_ride_opens() {
    let Some(python) = python::venv("can") else { return };
    let bench = Bench::new(PROGRAM);
    let run = bench.run("ride --speed 4 --steer-rate 2 --time-limit 1 --csv ride.csv --mcap ride.mcap -q");
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{run:?}");
    let mcap = read(&python, &bench.path("ride.mcap"), &[]);
    is_table(&mcap, &bench.read("ride.csv"), 0.0);
    assert!(mcap["messages"].as_array().expect("messages").len() >= 1000);
    assert_eq!(mcap["topic"], "/ride");
    assert!(
        mcap["schema"]["properties"]["roll"]["description"].as_str().is_some_and(|text| text.contains("rad"))
    );
    let configuration = mcap["metadata"]["configuration"].as_str().expect("a text");
    let configuration: Value = serde_json::from_str(configuration).expect("JSON");
    assert_eq!(configuration["start"]["speed_m_s"], 4.0);
    bench.run("ride --speed 4 --csv a --mcap a").rejected_naming(&["--csv", "--mcap"]);
    bench.run("ride --speed 4 --mcap no/such/a.mcap").rejected_naming(&["no/such"]);
}

/// Situation: 120 broadcasts on CAN, some with missing frames. Action: monitor them with a table and as MCAP, read the
/// latter, whole and cut in its middle.
/// Must hold: the rows of the table at the receiver's times, the boards' unknown values without a key; the cut file has
/// the first rows.
#[test]
fn a_monitored_board_opens() {
    let Some(python) = python::venv("can") else { return };
    let bench = Bench::new(PROGRAM);
    let lines = (0..120).flat_map(|n| {
        broadcast(n).into_iter().enumerate().filter(move |(k, _)| n % 9 != 4 || *k != n as usize % 3).map(
            move |(_, message)| {
                let frame = message.frame();
                let bytes: String = frame.bytes.iter().map(|byte| format!("{byte:02X}")).collect();
                format!("({:.6}) can0 {:03X}#{bytes}\n", 1.7e9 + 0.02 * f64::from(n), frame.identifier)
            },
        )
    });
    bench.write("ride.log", lines.collect::<String>());
    let run = bench.run("monitor --can ride.log --csv ride.csv --mcap ride.mcap");
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{run:?}");
    let (table, path) = (bench.read("ride.csv"), bench.path("ride.mcap"));
    let mcap = read(&python, &path, &[]);
    is_table(&mcap, &table, 1.7e9);
    assert_eq!(mcap["topic"], "/can");
    let bytes = std::fs::read(&path).expect("the file");
    bench.write("cut.mcap", &bytes[..bytes.len() / 2]);
    let cut = read(&python, &bench.path("cut.mcap"), &["--cut"]);
    let (rows, all) = (cut["messages"].as_array().expect("rows"), mcap["messages"].as_array().expect("rows"));
    assert!((50..110).contains(&rows.len()), "{}", rows.len());
    assert_eq!(rows[..], all[..rows.len()]);
}
