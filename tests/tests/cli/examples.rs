//! The examples of the library run as they are.

#[path = "../../../sim-host/examples/basin.rs"]
mod basin;
#[path = "../../../sim-host/examples/own_law.rs"]
mod own_law;
#[path = "../../../sim-host/examples/own_rider.rs"]
mod own_rider;
#[path = "../../../sim-host/examples/own_sensor.rs"]
mod own_sensor;
#[path = "../../../sim-host/examples/ride.rs"]
mod ride;

use tests::cli::repository;

type Main = fn() -> Result<(), Box<dyn std::error::Error>>;

/// Situation: the programs in the folder of examples.
/// Action: run each.
/// Must hold: none returns an error or panics; each file of the folder is among them.
#[test]
fn the_examples_run() {
    let all: [(&str, Main); 5] = [
        ("basin", basin::main),
        ("own_law", own_law::main),
        ("own_rider", own_rider::main),
        ("own_sensor", own_sensor::main),
        ("ride", ride::main),
    ];
    let mut files: Vec<String> = std::fs::read_dir(repository("sim-host/examples"))
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().replace(".rs", ""))
        .collect();
    files.sort();
    assert_eq!(files, all.map(|(name, _)| name));
    for (name, main) in all {
        main().unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}
