//! Meaning of the options: laws, presets, defaults, help.

use serde_json::{Value, json};
use tests::cli::{Bench, repository, word};

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

fn end(bench: &Bench, law: &str) -> Value {
    bench.json(&format!("ride --speed 4 --steer-rate 2 --assist ideal --law {law}"))["final"].clone()
}

/// Situation: every law by name, and two tables that are laws with names.
/// Action: ride with each.
/// Must hold: all ride; a table of zeros is no law; a straight table is cl2 to rounding.
#[test]
fn laws_by_name_and_by_file() {
    let bench = Bench::new(PROGRAM);
    let ends = ["none", "h", "f", "g", "cl1", "cl2:3"].map(|law| end(&bench, law));
    for (i, one) in ends.iter().enumerate() {
        assert!(ends[..i].iter().all(|other| other != one), "two laws with the same ride");
    }
    assert_eq!(end(&bench, "h-cut"), ends[1], "below 7.5 m/s the cut does nothing");
    bench.write("zero.toml", "speed_m_s = [0]\ngain_nm_s_rad = [0]\n");
    assert_eq!(end(&bench, "zero.toml"), ends[0]);
    bench.write("line.toml", "speed_m_s = [0.0, 10.0]\ngain_nm_s_rad = [30.0, 0.0]\nsource = 'cl2:3'\n");
    let line = end(&bench, "line.toml");
    for (key, value) in ends[5].as_object().unwrap() {
        assert!((value.as_f64().unwrap() - line[key].as_f64().unwrap()).abs() < 1e-9, "{key}");
    }
    assert!(end(&bench, &word(&repository("data/laws/example.toml")))["t"] == json!(6.0));
}

/// Situation: no options, the product preset, the product preset with options of its own, ideal.
/// Action: read the configuration of a ride's document.
/// Must hold: the documented defaults; options have priority over the preset.
#[test]
fn defaults_and_presets_are_as_documented() {
    let bench = Bench::new(PROGRAM);
    let config = |options: &str| bench.json(&format!("ride --speed 4 {options}"))["config"].clone();
    let expect = |config: Value, expected: Value| {
        for (key, value) in expected.as_object().unwrap() {
            assert_eq!(&config[key], value, "{key}");
        }
    };
    let thesis = json!({
        "preset": "thesis", "assist": "firmware", "schedule_speed": "front", "imu": "euler",
        "torque_limit_nm": null, "rate_limit_nm_s": null, "taper_m_s": null, "sensor_delay_s": 0.0,
        "control_rate_hz": 1000.0, "step_s": 0.001, "time_limit_s": 6.0, "recovered_below": 0.1,
    });
    let default = config("");
    assert_eq!((&default["bicycle"]["name"], &default["law"]["name"]), (&json!("rigid_jason"), &json!("h")));
    expect(default, thesis);
    let product = json!({"torque_limit_nm": 7.0, "rate_limit_nm_s": 100.0, "taper_m_s": [0.5, 1.5]});
    let flashed = config("--preset product");
    assert_eq!(flashed["law"]["name"], json!("h-cut"));
    // Twice as fast falling.
    assert_eq!(flashed["parameters"]["limits.fall_nm_s"], json!("200"));
    expect(flashed, product);
    expect(
        config("--preset product --torque-limit none --rate-limit 50 --taper 1:2 --sensor-delay 20ms"),
        json!({"torque_limit_nm": null, "rate_limit_nm_s": 50.0, "taper_m_s": [1.0, 2.0], "sensor_delay_s": 0.02}),
    );
    expect(config("--assist ideal"), json!({"assist": "ideal", "control_rate_hz": null}));
    expect(config("--law none"), json!({"assist": "none", "control_rate_hz": null}));
}

/// Situation: a strong knock at speed, a limited motor.
/// Action: ride with and without the limit.
/// Must hold: the torque stays within the limit and reaches it; without it, it exceeds it.
#[test]
fn limits_limit() {
    let bench = Bench::new(PROGRAM);
    let peak = |options: &str| {
        let line = format!("ride --speed 4 --steer-rate 5 {options}");
        bench.json(&line)["effort"]["peak_torque_nm"].as_f64().unwrap()
    };
    assert!(peak("") > 5.0);
    assert_eq!(peak("--torque-limit 3"), 3.0);
}

/// Situation: the help of every command, and every example in it.
/// Action: request the help; give the examples' options with `--help` after them.
/// Must hold: examples are there, and no option in them is unknown.
#[test]
fn every_help_has_examples_whose_options_exist() {
    let bench = Bench::new(PROGRAM);
    for command in [
        "",
        "basin",
        "ride",
        "eigen",
        "schema",
        "bicycle",
        "bicycle list",
        "bicycle show",
        "bicycle check",
        "bicycle accel",
        "monitor",
        "param",
        "param list",
        "param get",
        "param set",
        "param store",
        "param reset",
        "param export",
        "param import",
        "faults",
        "identify",
        "identify weave",
        "record",
    ] {
        let help = bench.run(&format!("{command} --help"));
        assert_eq!(help.code, Some(0), "{command}");
        let examples: Vec<&str> = help.stdout.lines().filter_map(|l| l.strip_prefix("  sim-host ")).collect();
        assert!(!examples.is_empty(), "no example in: {command} --help");
        for example in examples {
            let texts = example.split("  ").next().unwrap().split(" > ").next().unwrap();
            let run = bench.run(&format!("{texts} --help"));
            assert_eq!(run.code, Some(0), "{texts}: {}", run.stderr);
        }
    }
}

/// Situation: a fall, a wrong option, a count out of range, a missing file, a quantity out of range, the version.
/// Action: run each.
/// Must hold: exit codes 0, 2, 2, 1, 1 and 0; the version has the commit in it.
#[test]
fn exit_codes() {
    let bench = Bench::new(PROGRAM);
    let code = |line: &str| bench.run(line).code;
    assert_eq!(code("ride --speed 1 --steer-rate 90"), Some(0));
    for usage in
        ["", "ride", "ride --speed 4 --nonsense", "ride --speed four", "basin --speeds 1:2", "eigen --json="]
    {
        assert_eq!(code(usage), Some(2), "{usage}");
    }
    for count in
        ["basin --threads 0", "basin --uncertain 1", "basin --threads -2", "ride --speed 4 --seed -1"]
    {
        assert_eq!(code(count), Some(2), "{count}");
    }
    assert_eq!(code("eigen --bicycle missing.toml"), Some(1));
    assert_eq!(code("basin --max-rate 0"), Some(1));
    let version = bench.run("--version").stdout;
    let expected = format!("sim-host {} (", env!("CARGO_PKG_VERSION"));
    assert!(version.starts_with(&expected) && version.trim_end().ends_with(')'), "{version}");
}
