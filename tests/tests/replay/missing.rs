//! Sensors that were not recorded.

use super::{Bench, HEADER, PROGRAM, bench, lines, number, rows, table_of};
use serde_json::{Value, json};

fn texts(value: &Value) -> Vec<&str> {
    value.as_array().unwrap().iter().map(|word| word.as_str().unwrap()).collect()
}

/// Situation: a ride without steer rate, front wheel and drive.
/// Action: replay it under the flashed configuration, which declares them.
/// Must hold: they are switched off and reported, with the columns that the map names and the checks that depend on
/// them; it engages nevertheless.
#[test]
fn missing_sensors_are_switched_off_and_reported() {
    let bench = Bench::new(PROGRAM);
    let header = HEADER.replace("steer_rate", "other").replace("front", "more");
    bench.write("ride.csv", table_of(&header, &lines(&rows(400))));
    let document = bench.json("replay ride.csv --map extract");
    assert_eq!(document["switched_off"], json!(["steer-rate", "front-wheel", "motor-report"]));
    assert_eq!(document["absent"], json!(["steer-rate (`steer_rate`)", "front-wheel (`front`)"]));
    let unchecked = texts(&document["unchecked"]).join("\n");
    for word in ["wheels", "steer: angle and rate", "motor: no report", "motor response"] {
        assert!(unchecked.contains(word), "{word}: {unchecked}");
    }
    assert!((1.2..1.7).contains(&number(&document["engaged_s"])));
    let text = bench.run("replay ride.csv --map extract").stdout;
    for word in ["switched off: steer-rate, front-wheel, motor-report", "`steer_rate`", "not checked: wheels"]
    {
        assert!(text.contains(word), "{text}");
    }
}

/// Situation: a ride with all the sensors of the table.
/// Action: replay it.
/// Must hold: only the drive's report is switched off, and the sign check of the motor.
#[test]
fn recorded_sensors_stay_on() {
    let document = bench(400).json("replay ride.csv --map extract");
    assert_eq!(document["switched_off"], json!(["motor-report"]));
    assert_eq!((document["absent"].clone(), texts(&document["unchecked"]).len()), (json!([]), 2));
    let named = |name: &str| {
        let checks = document["checks"].as_array().unwrap();
        checks.iter().find(|check| check["name"] == name).unwrap_or_else(|| panic!("no {name}")).clone()
    };
    // The largest residual of a check is above the added noise and below its limit.
    for (name, least, limit) in
        [("gyro range", 0.04, 35.0), ("rear wheel range", 4.0, 30.0), ("yaw", 0.0, 2.0)]
    {
        let check = named(name);
        let largest = number(&check["largest_residual"]);
        assert!(largest > least && largest < limit && number(&check["limit"]) == limit, "{check}");
    }
}

/// Situation: a ride without gyro, one without a wheel.
/// Action: replay each.
/// Must hold: rejected: there is nothing to replay; with the columns that the map names and the existing ones.
#[test]
fn without_gyro_or_wheel_there_is_no_replay() {
    let bench = Bench::new(PROGRAM);
    for (header, named) in [
        (HEADER.replace("gx,gy,gz", "a,b,c"), ["no gyro", "`gx`", "a, b, c"]),
        (HEADER.replace("front,rear", "d,e"), ["no wheel speed", "`rear`", "d, e"]),
    ] {
        bench.write("ride.csv", table_of(&header, &lines(&rows(50))));
        bench.run("replay ride.csv --map extract").rejected_naming(&named);
    }
    let mut blank = lines(&rows(50));
    for line in &mut blank {
        *line = format!("{},,", line.rsplitn(3, ',').last().unwrap());
    }
    bench.write("ride.csv", table_of(HEADER, &blank));
    bench.run("replay ride.csv --map extract").rejected_naming(&["rear-wheel (no value in `rear`)"]);
    bench.write("ride.csv", "a,b\n1,2\n");
    bench.run("replay ride.csv").rejected_naming(&["no built-in map", "--map"]);
}

/// Situation: the table of a ride, without samples, and its frames.
/// Action: replay both, and identify a sensor and a loop from the table.
/// Must hold: the table is rejected with the option that writes what can be replayed; the frames are replayed.
#[test]
fn the_table_of_a_ride_is_no_recording() {
    let bench = Bench::new(PROGRAM);
    assert_eq!(
        bench.run("ride -q --speed 4 --steer-rate 1 --csv ride.csv --frames ride.frames").code,
        Some(0)
    );
    for command in ["replay", "identify loop", "identify sensor --sensor gyro"] {
        let run = bench.run(&format!("{command} ride.csv"));
        let named = ["ride.csv: ", "`ride --csv`", "`ride --frames FILE`"];
        assert!(
            run.code == Some(1) && named.iter().all(|text| run.stderr.contains(text)),
            "{command}: {run:?}"
        );
    }
    assert_eq!(bench.run("replay -q ride.frames").code, Some(0));
}
