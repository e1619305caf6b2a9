//! `sim-host identify weave`: recordings of any quality, named by file and line; tables, documents, figures.

use control::Law;
use serde_json::Value;
use sim_host::bicycle::catalogue;
use sim_host::eigen::{Feedback, LinearActuator};
use sim_host::study::balance_assist::RIDERLESS;
use sim_host::weave::measured::Measured;
use tests::cli::{Bench, repository};
use tests::json_schema::violations;
use tests::knock::{Knocked, Recording, SplitMix64, csv};

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

/// A recording of the prototype with a perfect motor, from 0.3 s before the push on.
fn recording(kappa: f32, speed_m_s: f64, seed: u64) -> String {
    let bicycle = catalogue::load(RIDERLESS).expect("ships").parameters;
    let feedback = Feedback::Law(Law::BalanceAssist { kappa });
    let knocked = Knocked { bicycle, feedback, actuator: LinearActuator::default(), speed_m_s };
    let how = Recording {
        before_s: 0.3,
        push_s: 0.2,
        after_s: 1.5,
        rate_hz: 100.0,
        noise_rad_s: 0.02,
        memory_s: 0.02,
    };
    csv(&knocked.record(&how, &mut SplitMix64(seed)))
}

/// Two repeats at 12 km/h and one at 10.8 km/h.
fn bench() -> Bench {
    let bench = Bench::new(PROGRAM);
    for n in [1, 2] {
        bench.write(&format!("gain8_speed12kmh_{n}.csv"), recording(8.0, 12.0 / 3.6, n));
    }
    bench.write("gain5_speed10.8kmh_1.csv", recording(5.0, 3.0, 3));
    bench
}

/// Situation: recordings whose names contain gain and speed.
/// Action: find the weave, as text and as every kind of file.
/// Must hold: the perfect motor's eigenvalue, with which the recordings were made, is near; repeats are together; the
/// document is valid; tables and figures are there.
#[test]
fn the_weave_of_recordings_is_found() {
    let bench = bench();
    let line = "identify weave gain8_speed12kmh_1.csv gain8_speed12kmh_2.csv gain5_speed10.8kmh_1.csv";
    let run = bench.run(&format!(
        "{line} --json o.json --csv o.csv --svg o.svg --png o.png --toml o.toml --source here"
    ));
    assert_eq!((run.code, &*run.stderr), (Some(0), ""), "{run:?}");
    for word in ["2 of 2", "1 of 1", "perfect motor", "knock", "With the fitted motor"] {
        assert!(run.stdout.contains(word), "{word}: {}", run.stdout);
    }
    let document: Value = serde_json::from_str(&bench.read("o.json")).expect("JSON");
    let schema = std::fs::read_to_string(repository("docs/schema/identify-weave.json")).expect("a schema");
    let schema: Value = serde_json::from_str(&schema).expect("JSON");
    assert_eq!(violations(&schema, &document), [""; 0]);
    let entries = document["weave"].as_array().expect("entries");
    let speeds: Vec<f64> = entries.iter().map(|e| e["speed_m_s"].as_f64().expect("a speed")).collect();
    assert!(speeds.len() == 2 && (speeds[0] - 3.0).abs() < 1e-9 && (speeds[1] - 12.0 / 3.6).abs() < 1e-9);
    for entry in entries {
        for (i, key) in ["decay_1_s", "frequency_rad_s"].into_iter().enumerate() {
            let truth = entry["predicted"]["perfect"][i].as_f64().expect("a pair");
            let found = entry[key]["mean"]["value"].as_f64().expect("a mean");
            assert!((found - truth).abs() < 0.3, "{key}: {found} {truth}");
        }
    }
    let table = bench.read("o.csv");
    assert_eq!(table.lines().filter(|l| l.starts_with("recording,")).count(), 3);
    assert_eq!(table.lines().filter(|l| l.starts_with("pooled,")).count(), 2);
    let written: Measured = toml::from_str(&bench.read("o.toml")).expect("TOML");
    assert_eq!((&*written.source, written.weave.len(), written.weave[1].repeats), ("here", 2, 2));
    assert!(bench.read("o.svg").starts_with("<svg"));
    let schema = bench.run("schema identify-weave").stdout;
    let file = std::fs::read_to_string(repository("docs/schema/identify-weave.json")).expect("a schema");
    assert!(schema == file, "run: sim-host schema identify-weave > docs/schema/identify-weave.json");
}

/// Situation: a recording with other columns, degrees, seconds and name.
/// Action: give all that by options.
/// Must hold: the same result as of the plain one, from one axis; gain and speed of the options have priority.
#[test]
fn columns_units_and_names_are_given_by_options() {
    let bench = bench();
    let plain = bench.json("identify weave gain8_speed12kmh_1.csv --column gyro_x");
    let text = bench.read("gain8_speed12kmh_1.csv");
    let lines = text.lines().skip(1).map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        let seconds: f64 = cells[0].rsplit(':').next().and_then(|s| s.parse().ok()).expect("seconds");
        let degrees = cells[3].parse::<f64>().expect("a rate").to_degrees();
        format!("{degrees};{seconds}\n")
    });
    let other: String =
        ["roll;clock\n".to_owned()].into_iter().chain(lines).collect::<String>().replace(';', ",");
    bench.write("v3.3333333 k8.csv", other);
    let named = "--column roll --time-column clock --unit deg/s --label 'v{speed_m_s} k{gain}'";
    let by_options = bench.json(&format!("identify weave 'v3.3333333 k8.csv' {named}"));
    let frequency =
        |d: &Value| d["recordings"][0]["weave"]["frequency_rad_s"]["value"].as_f64().expect("a number");
    assert!((frequency(&plain) - frequency(&by_options)).abs() < 1e-4);
    assert_eq!(by_options["recordings"][0]["gain"], 8.0);
    let over = bench.json("identify weave gain8_speed12kmh_1.csv --speed 3.5 --gain 6");
    assert_eq!((&over["weave"][0]["gain"], &over["weave"][0]["speed_m_s"]), (&6.0.into(), &3.5.into()));
    let lawless = bench.json("identify weave gain8_speed12kmh_1.csv --law none --bicycle benchmark");
    assert_eq!((&lawless["weave"][0]["gain"], &lawless["config"]["law"]), (&Value::Null, &"none".into()));
}

/// Situation: files that are damaged in places, and unusable files, beside a good one.
/// Action: find the weave.
/// Must hold: file, line, column and value are reported; valid lines are used; exit code 0, and 1 if nothing could be
/// used.
#[test]
fn errors_are_named_by_file_and_line() {
    let bench = bench();
    let good = bench.read("gain8_speed12kmh_1.csv");
    let mut lines: Vec<String> = good.lines().map(str::to_owned).collect();
    let cell = |line: &str, i: usize, new: &str| {
        let mut cells: Vec<&str> = line.split(',').collect();
        cells[i] = new;
        cells.join(",")
    };
    lines[3] = cell(&lines[3], 3, "NaN");
    lines[5] = cell(&lines[5], 2, "99");
    lines[7] = lines[6].clone();
    lines[9] = cell(&lines[9], 0, "2023-05-12 10:54:09.5");
    let last = lines.len() - 1;
    lines[last].truncate(30);
    bench.write("gain8_speed12kmh_3.csv", lines.join("\n"));
    let head = |n: usize| good.lines().take(n).map(|l| format!("{l}\n")).collect::<String>();
    bench.write("gain8_speed12kmh_4.csv", head(12));
    let still =
        good.lines().map(|l| if l.starts_with('T') { format!("{l}\n") } else { cell(l, 3, "0.01") + "\n" });
    bench.write(
        "gain8_speed12kmh_5.csv",
        still.map(|l| cell(&l, 2, if l.starts_with('T') { "gyro_z" } else { "0.02" })).collect::<String>(),
    );
    bench.write("other.csv", &good);
    bench.write("gain8_speed12kmh_6.csv", good.replace("gyro_x", "roll").replace("gyro_z", "yaw"));
    bench.write("gain99_speed12kmh_1.csv", &good);
    let all = "gain8_speed12kmh_3.csv gain8_speed12kmh_4.csv gain8_speed12kmh_5.csv gain8_speed12kmh_6.csv other.csv missing.csv gain99_speed12kmh_1.csv";
    let run = bench.run(&format!("identify weave {all}"));
    assert_eq!(run.code, Some(0), "{run:?}");
    let end = last + 1;
    for output in [
        "gain8_speed12kmh_3.csv: line 4: `gyro_x` = `NaN` is not a number from -50 to 50 rad/s; left out",
        "gain8_speed12kmh_3.csv: line 6: `gyro_z` = `99` is not a number from -50 to 50 rad/s; left out",
        "gain8_speed12kmh_3.csv: line 8: `Time` stands",
        "gain8_speed12kmh_3.csv: line 10: `Time` goes back",
        &format!("gain8_speed12kmh_3.csv: line {end}: "),
        "gain8_speed12kmh_4.csv: not used: 11 samples in the window; at least 20",
        "gain8_speed12kmh_5.csv: not used: ",
        "gain8_speed12kmh_6.csv: not used: line 1: column `gyro_x` (or --column) is missing; there are Time",
        "other.csv: not used: its speed is not known",
        "missing.csv: not used: its speed is not known",
        "gain99_speed12kmh_1.csv: not used: law `balance-assist:99`: law.balance-assist.kappa = 99 is outside 0.001 to 20",
    ] {
        assert!(run.stderr.contains(output), "{output}: {}", run.stderr);
    }
    assert!(run.stdout.contains("1 of 4"), "{}", run.stdout);
    let run = bench.run("identify weave other.csv gain8_speed12kmh_4.csv --json");
    assert_eq!((run.code, &*run.stdout), (Some(1), ""), "{run:?}");
    assert!(run.stderr.contains("no file could be used"), "{}", run.stderr);
}

/// Situation: options that are wrong or inconsistent.
/// Action: give them.
/// Must hold: rejected, naming option, value and range; nothing is written.
#[test]
fn wrong_options_are_named() {
    let bench = bench();
    let files = bench.files();
    let good = "identify weave gain8_speed12kmh_1.csv";
    for (line, named) in [
        (format!("{good} --speed -1"), &["--speed", "-1", "0 to 30"][..]),
        (format!("{good} --gain 21"), &["--gain", "21", "0.001 to 20"]),
        (format!("{good} --label 'gain{{gian}}'"), &["--label", "{gain}", "{speed_kmh}"]),
        (format!("{good} --label 'gain{{gain'"), &["--label", "not closed"]),
        (format!("{good} --from 2s --to 1s"), &["--to", "1", "2"]),
        (format!("{good} --bicycle unicycle"), &["`unicycle`"]),
        (format!("{good} ./gain8_speed12kmh_1.csv"), &["gain8_speed12kmh_1.csv", "given twice"]),
        (format!("{good} --csv x --toml x"), &["--csv", "--toml", "same place"]),
        (format!("{good} --json nowhere/x"), &["nowhere"]),
    ] {
        bench.run(&line).rejected_naming(named);
    }
    for (line, word) in [
        ("identify weave".to_owned(), "FILE"),
        (format!("{good} --unit rpm"), "deg/s"),
        (format!("{good} --from 5"), "20ms"),
        (format!("{good} --beside all"), "offset"),
    ] {
        let run = bench.run(&line);
        assert!(run.code == Some(2) && run.stderr.contains(word), "{line}: {}", run.stderr);
    }
    assert_eq!(bench.files(), files);
}
