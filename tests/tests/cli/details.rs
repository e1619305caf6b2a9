//! Misleading details: names of files, remarks in them, numbers that are zero or tiny.

use serde_json::json;
use std::io::Write;
use std::process::Stdio;
use tests::cli::{Bench, bicycle_with, repository};

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

/// Situation: a bicycle in a file whose name has a `#`, and one on standard input.
/// Action: check both; ride the second over two cells of a sweep.
/// Must hold: both are read; a name that is no file still names a set of a collection.
#[test]
fn names_with_a_hash_and_standard_input() {
    let bench = Bench::new(PROGRAM);
    bench.write("my bike #2.toml", bicycle_with("w", "w = 1.1"));
    assert_eq!(
        bench.json("bicycle check --bicycle 'my bike #2.toml'")["bicycle"]["parameters"]["w"],
        json!(1.1)
    );
    bench.run("bicycle check --bicycle 'my bike #3.toml'").rejected_naming(&["my bike"]);
    for line in [
        "bicycle check --bicycle -",
        "basin compare --speeds 4 --max-rate 1 --scan-step 1 a=--bicycle=- b=--bicycle=-",
    ] {
        let mut child = bench.command(line).stdin(Stdio::piped()).stdout(Stdio::null()).spawn().unwrap();
        child.stdin.take().unwrap().write_all(bicycle_with("w", "w = 1.1").as_bytes()).unwrap();
        assert!(child.wait().unwrap().success(), "{line}");
    }
}

/// Situation: remarks of a wrong kind in a bicycle's file, another form of file, a head angle for the tilt, a tiny
/// number.
/// Action: check the bicycles.
/// Must hold: rejected with file, key and value; the head angle causes a warning with the corresponding tilt; no line
/// of zeros.
#[test]
fn remarks_are_checked() {
    let bench = Bench::new(PROGRAM);
    for (line, named) in [
        ("w = 1.02\nschema = 99", &["`schema` = 99", "reads 1"][..]),
        ("w = 1.02\nrider_included = 'yes'", &["`rider_included`", "boolean", "yes"]),
        ("w = 1e-320", &["`w` = 1e-320", "0.1 to 5 m"]),
    ] {
        bench.write("my.toml", bicycle_with("w", line));
        bench.run("bicycle check --bicycle my.toml").rejected_naming(&[&["my.toml"], named].concat());
    }
    bench.write("my.toml", bicycle_with("source", "source = 5"));
    bench.run("bicycle check --bicycle my.toml").rejected_naming(&["my.toml", "`source`", "string"]);
    bench.write("my.toml", bicycle_with("w", "w = 1.02\nschema = 1\nrider_included = true"));
    assert_eq!(bench.run("bicycle check --bicycle my.toml").code, Some(0));
    bench.write("my.toml", bicycle_with("lam", "lam = 1.2566"));
    let run = bench.run("bicycle check --bicycle my.toml");
    assert!(run.stderr.contains("head angle") && run.stderr.contains("0.3142 rad"), "{}", run.stderr);
    assert!(run.stdout.contains("doubtful"), "{}", run.stdout);
}

/// Situation: an undisturbed ride, unstable at its speed.
/// Action: ride, read the text.
/// Must hold: it is not called recovered in text, and its document reports it as undisturbed.
#[test]
fn an_undisturbed_ride_is_not_called_recovered() {
    let bench = Bench::new(PROGRAM);
    let text = bench.run("ride --law none --speed 2").stdout;
    assert!(text.contains("undisturbed") && !text.contains("recovered"), "{text}");
    assert_eq!(bench.json("ride --law none --speed 2")["undisturbed"], json!(true));
    assert_eq!(bench.json("ride --law none --speed 2 --steer-rate 1e-9")["undisturbed"], json!(false));
}

/// Situation: the table of a ride.
/// Action: request the accelerations of its states.
/// Must hold: a line for each, the first those of the same state written as states and torques; a table with `;` is
/// rejected with the reason.
#[test]
fn the_table_of_a_ride_is_one_of_states() {
    let bench = Bench::new(PROGRAM);
    assert_eq!(bench.run("ride --speed 4 --steer-rate 1 --time-limit 0.05 --csv ride.csv -q").code, Some(0));
    let table = bench.read("ride.csv");
    let answer = bench.run("bicycle accel --states ride.csv");
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    assert_eq!(answer.stdout.lines().count(), 1 + 50);
    let row: Vec<&str> = table.lines().filter(|l| !l.starts_with('#')).nth(20).unwrap().split(',').collect();
    let header: Vec<&str> = table.lines().find(|l| !l.starts_with('#')).unwrap().split(',').collect();
    let of = |name: &str| row[header.iter().position(|h| *h == name).unwrap()];
    let states = ["roll", "steer", "roll_rate", "steer_rate", "rear_wheel_rate"].map(of).join(",");
    bench.write(
        "states.csv",
        format!(
            "roll,steer,roll_rate,steer_rate,rear_wheel_rate,roll_torque,steer_torque\n{states},0,{}\n",
            of("motor_torque")
        ),
    );
    let same = bench.run("bicycle accel --states states.csv").stdout;
    assert_eq!(same.lines().nth(1), answer.stdout.lines().nth(20));
    bench.write("semicolons.csv", "roll;steer\n1;2\n");
    bench.run("bicycle accel --states semicolons.csv").rejected_naming(&["`roll` is missing", "commas"]);
}

/// Situation: more eigenvalues requested than can be found.
/// Action: run.
/// Must hold: those found are written, and a note gives their number and speed.
#[test]
fn missing_eigenvalues_are_reported() {
    let bench = Bench::new(PROGRAM);
    let run = bench.run("eigen --rider smart --roots 40 --speeds 4");
    assert!(run.code == Some(0) && run.stderr.contains("--roots 40: "), "{}", run.stderr);
    assert_eq!(bench.run("eigen --rider smart --roots 8 --speeds 4").stderr, "");
}

/// Situation: options that act on nothing beside the others.
/// Action: run with them, and with what they act on.
/// Must hold: refused as wrong usage, or with the key; a seed that draws nothing and the use of no rider are warnings.
#[test]
fn options_that_act_on_nothing_are_told() {
    let bench = Bench::new(PROGRAM);
    for (line, named) in
        [("eigen --roots 8 --speeds 4", "--roots: without a rider"), ("eigen --modes --speeds 4", "--csv")]
    {
        let run = bench.run(line);
        assert!(run.code == Some(2) && run.stderr.contains(named), "{line}: {run:?}");
    }
    for line in
        ["eigen --roots 8 --speeds 4 --law h --actuator-delay 5ms", "eigen --modes --speeds 4 --csv m.csv"]
    {
        let run = bench.run(line);
        assert!(run.code == Some(0) && run.stderr.is_empty(), "{line}: {run:?}");
    }
    bench.run("basin --speeds 4 --adaptive-speeds").rejected_naming(&["--adaptive-speeds", "has one"]);
    let seeded = "ride --speed 4 --seed 5";
    let warned = |line: &str| bench.run(line).stderr.contains("--seed has no effect");
    assert!(warned(seeded));
    assert!(!warned(&format!("{seeded} --sensor gyro:noise=0.01")));
    assert!(!warned("ride --speed 4"));
    for command in ["ride --speed 4", "basin --speeds 4 --max-rate 1", "eigen --speeds 4"] {
        for option in ["--delay 30ms", "--gains best", "--gains-outside hold"] {
            let warned = |rider: &str| bench.run(&format!("{command} --rider {rider} {option}")).stderr;
            let name = option.split(' ').next().unwrap_or_default();
            assert_eq!(
                warned("none"),
                format!("warning: {name} has no effect: the rider is none\n"),
                "{command}"
            );
            assert_eq!(warned("smart"), "", "{command} {option}");
        }
    }
}

/// Situation: a start without a speed, and limits of the ideal law.
/// Action: run.
/// Must hold: the message has the range and the option, and no value that nobody gave.
#[test]
fn messages_are_about_what_was_given() {
    let bench = Bench::new(PROGRAM);
    bench.write("still.toml", "start = { steer_rate_rad_s = 1 }\n");
    let run = bench.run("ride --scenario still.toml");
    assert!(run.code == Some(1) && run.stderr.contains("must be given, from -30 to 30 m/s"), "{run:?}");
    assert!(!run.stderr.contains("NaN"), "{run:?}");
    bench
        .run("ride --speed 4 --assist ideal --torque-limit 3")
        .rejected_naming(&["--torque-limit", "flashed code"]);
    bench.run("ride --speed 4 --assist ideal --sensor-delay 5ms").rejected_naming(&["--sensor-delay"]);
    bench.run("ride --speed 4 --assist ideal --preset product").rejected_naming(&["--preset"]);
}

/// Situation: the table of a ride of 6 s.
/// Action: read its times.
/// Must hold: each is the number of its milliseconds as typed, no multiple of the nearest number to 1 ms.
#[test]
fn times_are_whole_milliseconds() {
    let bench = Bench::new(PROGRAM);
    let table = bench.run("ride --speed 6 --steer-rate 1 --csv -").stdout;
    let times: Vec<&str> =
        table.lines().skip(3).map(|line| line.split(',').next().expect("a cell")).collect();
    assert_eq!(times.len(), 6000);
    for (ms, time) in times.iter().enumerate() {
        let typed = format!("{}.{:03}", ms / 1000, ms % 1000);
        assert_eq!(
            time.trim_end_matches('0').trim_end_matches('.'),
            typed.trim_end_matches('0').trim_end_matches('.')
        );
    }
}

/// Situation: files of an actuator, a sensor, a rider and a parameter, cut within their last line, and complete; an
/// interrupted basin.
/// Action: ride with each; compare the basin.
/// Must hold: a cut file causes a warning with its name, in the output and in the document, a complete one does not;
/// likewise the interrupted basin.
#[test]
fn possibly_cut_files_cause_a_warning() {
    let bench = Bench::new(PROGRAM);
    let shown = bench.run("rider show young").stdout;
    let sensor = std::fs::read_to_string(repository("data/sensors/hall-16.toml")).unwrap();
    for (option, file, text) in [
        ("--actuator", "a.toml", "time_constant_s = 0.01\nlimit_nm = 12\n"),
        ("--sensor", "s.toml", &sensor),
        ("--rider", "r.toml", &shown),
        ("--parameters", "p.toml", "[parameters]\n'limits.max_torque_nm' = 12\n"),
    ] {
        let line = format!("ride --speed 4 --steer-rate 1 --time-limit 0.1 {option} {file}");
        for (text, cut) in [(text, false), (text.trim_end(), true)] {
            bench.write(file, text);
            let run = bench.run(&format!("{line} --json"));
            assert_eq!(run.code, Some(0), "{run:?}");
            let warning = format!("{file}: its last line has no end");
            let document: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
            let recorded = document["config"]["warnings"].to_string().contains(&warning);
            assert_eq!((run.stderr.contains(&warning), recorded), (cut, cut), "{run:?}");
        }
    }
    let basin = |upper: &str| {
        format!(
            "{{\"speeds\": [4, 5], \"height\": {{\"upper\": [3, {upper}]}}, \"capped\": [false, false], \"search\": {{\"axis\": \"steer-rate\"}}}}"
        )
    };
    bench.write("part.json", basin("null"));
    bench.write("whole.json", basin("4"));
    let run = bench.run("basin compare part.json whole.json");
    assert!(run.stderr.contains("part.json is of an interrupted search: 1 of 2 speeds"), "{run:?}");
    assert_eq!(
        bench.run("basin compare whole.json whole.json --json").stderr.matches("interrupted").count(),
        0
    );
}

/// Situation: the published conditions, which have a gyro and the front wheel's speed; 6 s.
/// Action: ride with faults and sensor errors that cannot act, and with those that can.
/// Must hold: the first are told with the reason, in the output and in the document; the others are not.
#[test]
fn faults_that_cannot_act_are_told() {
    let bench = Bench::new(PROGRAM);
    let declared = "--set input.path.fitted=on";
    let no_sensor = "the controller has no such sensor (--set input.path.fitted=on)";
    for (options, warning) in [
        ("--fault path:missing", Some(no_sensor)),
        ("--sensor path:noise=0.1", Some(no_sensor)),
        ("--fault rear-wheel:nan@1s", Some("--set input.rear_wheel.fitted=on")),
        ("--fault motor-report:flip", Some("--set input.motor.fitted=on")),
        ("--fault gyro:stuck@100s", Some("it begins at 100 s, and the end is at 6.000 s")),
        ("--fault motor:dead@6s", Some("the end is at 6.000 s")),
        ("--fault gyro:stuck@0.1ms..0.2ms", Some("no control instant is in its time")),
        ("--law none --fault motor:dead", Some("without a law")),
        ("--rider smart --fault gyro:nan", Some("without a law")),
        (&format!("--fault path:missing {declared}"), None),
        (&format!("--sensor path:noise=0.1 {declared}"), None),
        ("--fault gyro:stuck@5.999s", None),
        ("--fault clock:stuck@1s --fault motor:dead --fault engage:flip", None),
        ("--fault rear-wheel:missing --set input.rear_wheel.fitted=on --set input.wheel=rear", None),
        ("--sensor mpu6050-robot", None),
    ] {
        let run = bench.run(&format!("ride --speed 6 --steer-rate 0.1 {options} --json"));
        assert_eq!(run.code, Some(0), "{options}: {run:?}");
        let document: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
        let recorded = document["config"]["warnings"].to_string();
        for text in [&run.stderr, &recorded] {
            match warning {
                Some(warning) => {
                    assert!(text.contains("no effect") && text.contains(warning), "{options}: {text}");
                }
                None => assert!(!text.contains("no effect"), "{options}: {text}"),
            }
        }
    }
}

/// Situation: values that are checked after the options were read, given as options and in a file.
/// Action: run.
/// Must hold: each error begins with its option, or with file and key, and has the range.
#[test]
fn errors_name_the_option_or_the_key() {
    let bench = Bench::new(PROGRAM);
    for (line, begin) in [
        ("basin --speeds 4 --max-rate 500", "--max-rate: max rate (rad/s) = 500 is outside 0.01 to 100"),
        ("basin --speeds 4 --scan-step 50", "--scan-step: scan step (rad/s) = 50 is outside 0.001 to 30"),
        ("basin --speeds 4 --tolerance 5", "--tolerance: tolerance (rad/s) = 5 is outside"),
        (
            "basin plane --speed 4 --max-steer-rate 900",
            "--max-steer-rate: largest steer rate (rad/s) = 900 is",
        ),
        ("ride --speed 4 --time-limit 4000", "--time-limit: time limit (s) = 4000 is outside 0.001 to 3600"),
        ("ride --speed 4 --recovered-below 7", "--recovered-below: recovered-below fraction = 7 is outside"),
        ("ride --speed 4 --sensor gyro:noise=-1", "--sensor: gyro noise = -1 is outside 0 to 1000"),
        ("ride --speed 4 --actuator scale=99", "--actuator: actuator scale = 99 is outside -10 to 10"),
        ("ride --speed 4 --bicycle-set foo=1", "--bicycle-set `foo`: no such parameter; there are w, c, lam"),
    ] {
        let run = bench.run(line);
        assert!(run.code == Some(1) && run.stderr.starts_with(&format!("error: {begin}")), "{run:?}");
    }
    for (text, begin) in [
        ("search = { max_rate = 500 }", "search.max_rate: max rate (rad/s) = 500 is outside 0.01 to 100"),
        ("time_limit_s = 4000", "time_limit_s: time limit (s) = 4000 is outside 0.001 to 3600"),
        ("plant = { actuator = { scale = 99 } }", "plant.actuator: actuator scale = 99 is outside -10 to 10"),
    ] {
        bench.write("wrong.toml", format!("{text}\n"));
        let run = bench.run("basin --speeds 4 --scenario wrong.toml");
        let begin = format!("error: scenario wrong.toml: {begin}");
        assert!(run.code == Some(1) && run.stderr.starts_with(&begin), "{run:?}");
    }
}
