//! Scenarios: files, what `--print-scenario` prints, the scenario in a result.

use proptest::prelude::*;
use serde_json::{Value, json};
use sim_host::scenario::Scenario;
use sim_host::scenario::setting::{ADAPTIVE, CONDITIONS, PLANE, SEARCH, START, Setting, UNCERTAIN};
use std::path::Path;
use tests::cli::{Bench, repository};
use tests::json_schema::violations;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

/// A file of every kind that options can name.
fn files(bench: &Bench) {
    let copy = |from: &str, to: &str| bench.write(to, std::fs::read(repository(from)).expect("is there"));
    copy("data/laws/example.toml", "law.toml");
    copy("data/riders/young.toml", "rider.toml");
    copy("data/sensors/hall-16.toml", "hall.toml");
    bench.write("motor.toml", "time_constant_s = 0.004\nlimit_nm = 6.5\n");
    bench.write(
        "set.toml",
        "law = 'cl2:3'\n[parameters]\n'limits.rise_nm_s' = 55\n'limits.end_stop' = 'off'\n",
    );
    let bicycle = bench.run("bicycle show --ini --bicycle rigid_luke").stdout;
    let measured = |line: &str| match line.strip_prefix("w = ") {
        Some(value) => format!("w = {value}+/-0.01\n"),
        None => format!("{line}\n"),
    };
    bench.write("bicycle.txt", bicycle.lines().map(measured).collect::<String>());
}

/// Options that between them use every file and every kind of setting.
const RIDES: [&str; 5] = [
    "",
    "--preset product --steer-rate 3",
    "--bicycle bicycle.txt --bicycle-set lam=0.35 --law law.toml --steer-rate 2 --torque-limit none --taper 0.1:0.7",
    "--rider rider.toml --gains best --delay 40ms --parameters set.toml --set limits.fall_nm_s=66 --roll-rate 0.4",
    "--preset product --sensor mpu6050-robot --sensor front-wheel:model=hall.toml --sensor gyro.y:bias=0.01 --sensor imu:pitch=0.1 \
     --actuator motor.toml,stop=0.7 --fault gyro.x:noise=0.1@1.5s..2s --seed 7 --fall flat=none --time-limit 3 --imu body",
];

/// Situation: rides with files of every kind and options of every kind.
/// Action: take the scenario from the result, ride it in a folder without those files; print the scenario of the options
/// and ride that where the files are.
/// Must hold: the same bytes all three times.
#[test]
fn a_result_contains_the_scenario_that_reproduces_it() {
    let (bench, elsewhere) = (Bench::new(PROGRAM), Bench::new(PROGRAM));
    files(&bench);
    for options in RIDES {
        let result = bench.run(&format!("ride --speed 4 {options} --json"));
        assert_eq!(result.code, Some(0), "{options}: {}", result.stderr);
        elsewhere.write("result.json", &result.stdout);
        assert_eq!(elsewhere.run("ride --scenario result.json --json").stdout, result.stdout, "{options}");
        let scenario = &serde_json::from_str::<Value>(&result.stdout).expect("JSON")["scenario"];
        elsewhere.write("scenario.json", scenario.to_string());
        assert_eq!(elsewhere.run("ride --scenario scenario.json --json").stdout, result.stdout, "{options}");
        let printed = bench.run(&format!("ride --speed 4 {options} --print-scenario"));
        bench.write("scenario.toml", &printed.stdout);
        assert_eq!(bench.run("ride --scenario scenario.toml --json").stdout, result.stdout, "{options}");
    }
}

/// Situation: a basin with drawn bicycles, and a plane.
/// Action: compute each again from its result, in a folder without its files; again with an option that changes it.
/// Must hold: the same document but for the computing time; another one with the option.
#[test]
fn a_basin_is_reproduced_from_its_result() {
    let (bench, elsewhere) = (Bench::new(PROGRAM), Bench::new(PROGRAM));
    files(&bench);
    let timeless = |run: &str, bench: &Bench| {
        let mut document = bench.json(run);
        document["seconds"] = Value::Null;
        document
    };
    let coarse = "--scan-step 2 --tolerance 0.5 --max-rate 8";
    for (command, options, other) in [
        ("basin", format!("--bicycle bicycle.txt --uncertain 2 --speeds 3:4:1 {coarse}"), "--speeds 3"),
        ("basin", format!("--rider rider.toml --axis roll-rate --speeds 4 {coarse}"), "--axis steer-rate"),
        ("basin plane", "--speed 4 --rays 4 --points 4".into(), "--rays 5"),
    ] {
        let first = timeless(&format!("{command} {options}"), &bench);
        elsewhere.write("result.json", first.to_string());
        let again = timeless(&format!("{command} --scenario result.json"), &elsewhere);
        assert_eq!(again, first, "{options}");
        let changed = timeless(&format!("{command} --scenario result.json {other}"), &elsewhere);
        assert_ne!(changed, first, "{options}");
    }
}

/// Situation: a scenario with one thing wrong each.
/// Action: ride it.
/// Must hold: rejected with the file, the key, the value and what is expected.
#[test]
fn a_wrong_scenario_is_rejected_with_its_key() {
    let bench = Bench::new(PROGRAM);
    let right = "law = 'h'\n[start]\nspeed_m_s = 4\n";
    bench.write("right.toml", right);
    assert_eq!(bench.run("ride --scenario right.toml").code, Some(0));
    for (added, named) in [
        ("lwa = 'h'", &["wrong.toml", "line 1", "lwa", "law"][..]),
        ("time_limit_s = 'x'", &["wrong.toml", "line 1", "\"x\""]),
        ("time_limit_s = 0", &["time limit", "= 0 ", "3600"]),
        ("torque_limit_nm = 'off'", &["wrong.toml", "line 1", "off", "none"]),
        ("torque_limit_nm = -1", &["wrong.toml: torque_limit_nm: ", "-1", "max_torque_nm"]),
        ("taper_m_s = [1]", &["wrong.toml", "line 1", "length"]),
        ("sensor_delay_s = 0.0025", &["wrong.toml: sensor_delay_s: ", "2.5 ms", "whole number"]),
        ("sensor_delay_s = -1", &["wrong.toml: sensor_delay_s: ", "-1000 ms", "0 to 1000"]),
        ("bicycle = 'bike'", &["unknown bicycle `bike`", "rigid_jason"]),
        ("bicycle = 1", &["wrong.toml", "line 1", "a name, a file"]),
        ("bicycle_set = { lam = 7 }", &["wrong.toml: bicycle_set: ", "`lam` = 7", "1.4"]),
        ("rider = { gains = 'best' }", &["wrong.toml: rider.table: ", "gains"]),
        ("rider = { table = 'young', gains = 'fit' }", &["line 1", "fit", "regression"]),
        ("rider = { table = 'young', delay_s = 2 }", &["wrong.toml: rider.delay_s: ", "= 2 ", "0 to 1"]),
        ("plant = { faults = ['gyro:melt'] }", &["line 1", "gyro:melt"]),
        (
            "plant = { sensors = [{ sensor = 'nose', noise = 1 }] }",
            &["wrong.toml: plant.sensors: ", "`nose`", "gyro"],
        ),
        ("plant = { sensors = [{ noise = 1 }] }", &["wrong.toml: plant.sensors: ", "`sensor`", "`model`"]),
        ("plant = { actuator = { voltage_v = 24 } }", &["wrong.toml: plant.actuator: ", "given together"]),
        ("parameters = { 'limits.nope' = 1 }", &["wrong.toml: parameters: ", "limits.nope"]),
        (
            "parameters = { 'limits.rise_nm_s' = -1 }",
            &["wrong.toml: parameters: ", "limits.rise_nm_s=-1", "outside"],
        ),
        ("fall = { roll_rad = 2 }", &["fall: roll", "90"]),
        ("search = { speeds = [6, 4] }", &["must rise", "4 m/s comes after 6"]),
        ("plant = { seed = -1 }", &["wrong.toml", "line 1", "a whole number from 0"]),
        ("uncertain = 1", &["wrong.toml: uncertain: ", "1 is outside 2 to 10000"]),
        ("law = { name = 'h', speed_m_s = [0], gain_nm_s_rad = [1] }", &["`h`", "built-in"]),
        (
            "plant = { sensors = [{ sensor = 'gyro' }] }",
            &["wrong.toml: plant.sensors: gyro: ", "needs a value"],
        ),
        ("assist = 'ideal'\nparameters = { 'predict.lead_s' = 0.05 }", &["predict.lead_s", "firmware only"]),
        ("plane = { rays = 4 }", &["wrong.toml: plane.speed: ", "must be given"]),
        ("plane = { speed = 40 }", &["speed (m/s) = 40", "0 to 30"]),
        ("torque_limit_nm = [1]", &["line 1", "a number"]),
    ] {
        bench.write("wrong.toml", format!("{added}\n{}", right.replace("law = 'h'\n", "")));
        bench.run("ride --scenario wrong.toml").rejected_naming(named);
    }
    bench.run("ride --scenario none.toml").rejected_naming(&["none.toml"]);
    bench.write("result.json", json!({"tool": {}, "config": {}}).to_string());
    bench.run("ride --scenario result.json").rejected_naming(&["result.json", "no `scenario`"]);
    bench.write("list.json", "[1]");
    bench.run("ride --scenario list.json").rejected_naming(&["list.json", "object"]);
    bench.write("bad.json", "{\"law\": \"h\",}");
    bench.run("ride --scenario bad.json").rejected_naming(&["bad.json", "line 1"]);
    bench.write("moved.json", json!({"start": {"speed_m_s": 4}, "bicycle": inline(0.3)}).to_string());
    assert_eq!(bench.run("ride --scenario moved.json").code, Some(0));
    bench.write("moved.json", json!({"start": {"speed_m_s": 4}, "bicycle": inline(7.0)}).to_string());
    bench.run("ride --scenario moved.json").rejected_naming(&["moved.json: bicycle: ", "`lam` = 7"]);
}

/// Situation: a right scenario, and one with a wrong delay and a wrong sensor.
/// Action: ride them with options that are wrong in themselves, or right.
/// Must hold: a wrong option is named without the file; a wrong value of the file by its key, also beside a right option;
/// of a list that file and options fill, both are named.
#[test]
fn a_wrong_option_beside_a_scenario_is_named_as_the_option() {
    let bench = Bench::new(PROGRAM);
    bench.write("right.toml", "sensor_delay_s = 0.002\n[start]\nspeed_m_s = 4\n");
    bench.write("late.toml", "sensor_delay_s = 0.0025\n[start]\nspeed_m_s = 4\n");
    bench.write("nose.toml", "[start]\nspeed_m_s = 4\n[plant]\nsensors = [{ sensor = 'nose', noise = 1 }]\n");
    for (options, expected) in [
        ("--scenario right.toml --sensor-delay 2.5ms", "error: --sensor-delay: 2.5 ms is not"),
        ("--scenario right.toml --steer-rate 200", "error: --steer-rate: steer_rate_rad_s = 200 is outside"),
        ("--scenario late.toml --torque-limit 7", "error: scenario late.toml: sensor_delay_s: 2.5 ms is not"),
        ("--scenario nose.toml --sensor gyro:noise=1", "error: scenario nose.toml: --sensor unknown sensor"),
        ("--speed 4 --sensor-delay 2.5ms", "error: --sensor-delay: 2.5 ms is not"),
    ] {
        let run = bench.run(&format!("ride {options}"));
        assert_eq!(run.code, Some(1), "{options}");
        assert!(run.stderr.starts_with(expected), "{options}: {}", run.stderr);
    }
}

/// Situation: a scenario with a limit as a parameter, a fault, a noisy gyro and a rider with its own delay.
/// Action: ride it with options that change each; sweep over a limit and over faults.
/// Must hold: the options have precedence, `none` removes, another rider has its own delay; the cells differ as their
/// labels say, and a cell is reproduced from its scenario.
#[test]
fn options_change_a_scenario() {
    let bench = Bench::new(PROGRAM);
    bench.write(
        "base.toml",
        "law = 'h'\nparameters = { 'limits.max_torque_nm' = 3, 'limits.fall_nm_s' = 60 }\n\
         rider = { table = 'young', delay_s = 0.05, gains = 'best' }\n\
         plant = { faults = ['motor:dead@0.1s'], sensors = [{ sensor = 'gyro', noise = 0.01 }] }\n\
         [start]\nspeed_m_s = 4\nsteer_rate_rad_s = 2\n",
    );
    let config =
        |options: &str| bench.json(&format!("ride --scenario base.toml {options}"))["config"].clone();
    let base = config("");
    assert_eq!((&base["torque_limit_nm"], &base["rider"]["delay_s"]), (&json!(3.0), &json!(0.05)));
    let changed = config("--torque-limit 6 --rate-limit 90 --rider smart --fault none --sensor none");
    assert_eq!((&changed["torque_limit_nm"], &changed["rate_limit_nm_s"]), (&json!(6.0), &json!(90.0)));
    assert_eq!((&changed["rider"]["delay_s"], &changed["rider"]["gains"]), (&json!(0.06), &json!("mean")));
    assert_eq!((&changed["plant"]["faults"], &changed["plant"]["sensors"]), (&json!([]), &json!({})));
    assert_eq!(config("--set limits.max_torque_nm=5 --torque-limit 6")["torque_limit_nm"], json!(5.0));

    let coarse = "--speeds 4 --scan-step 2 --tolerance 0.5 --max-rate 8 --time-limit 2";
    let sweep = "--over torque-limit=1,6 --over fault=none,motor:dead@0.1s --out cells";
    let document = bench.json(&format!("sweep --scenario base.toml {sweep} {coarse}"));
    let cells = document["cells"].as_array().expect("cells");
    let limit = |i: usize| cells[i]["config"]["torque_limit_nm"].clone();
    assert_eq!([0, 1, 2, 3].map(limit), [json!(1.0), json!(1.0), json!(6.0), json!(6.0)]);
    assert_ne!(cells[2]["found"], cells[3]["found"]);
    bench.write("cell.json", cells[2].to_string());
    let again = bench.json("basin --scenario cell.json");
    assert_eq!(again["height"]["upper"][0], cells[2]["found"][0]["height"]);
    bench.write("sweep.json", document.to_string());
    bench.run("basin --scenario sweep.json").rejected_naming(&["sweep.json", "cells[i].scenario"]);
}

/// Situation: two scenarios with searches of their own.
/// Action: compare their basins, with the same search and with different ones.
/// Must hold: the search of the scenarios is used; different ones are rejected with the labels.
#[test]
fn a_comparison_uses_the_search_of_its_scenarios() {
    let bench = Bench::new(PROGRAM);
    let search =
        "[search]\nspeeds = [3, 4]\naxis = 'roll-rate'\nmax_rate = 2\nscan_step = 0.5\ntolerance = 0.2\n";
    bench.write("a.toml", format!("law = 'h'\ntime_limit_s = 2\n{search}"));
    bench.write("b.toml", format!("law = 'f'\ntime_limit_s = 2\n{search}"));
    let compare = "basin compare 'a=--scenario a.toml' 'b=--scenario b.toml'";
    let document = bench.json(compare);
    assert_eq!(document["search"]["axis"], json!("roll-rate"));
    assert_eq!(document["cases"][1]["speeds"], json!([3.0, 4.0]));
    assert_eq!(document["cases"][1]["scenario"]["search"]["max_rate"], json!(2.0));
    bench.write("b.toml", format!("law = 'f'\n{}", search.replace("max_rate = 2", "max_rate = 3")));
    bench.run(compare).rejected_naming(&["`a` and `b`", "different searches"]);
}

/// Situation: the schema of scenarios, and the shipped ones.
/// Action: compare each with the schema; also one with an unknown key, and one with a wrong word.
/// Must hold: the shipped ones fit, the others do not.
#[test]
fn the_shipped_scenarios_fit_the_schema() {
    let schema: Value =
        serde_json::from_str(&Bench::new(PROGRAM).run("schema scenario").stdout).expect("JSON");
    for entry in std::fs::read_dir(repository("data/scenarios")).expect("a folder") {
        let path = entry.expect("an entry").path();
        let text = std::fs::read_to_string(&path).expect("is there");
        let scenario = json!(text.parse::<toml::Table>().expect("TOML"));
        assert_eq!(violations(&schema, &scenario), [""; 0], "{}", path.display());
    }
    for wrong in [json!({"lwa": "h"}), json!({"preset": "none"}), json!({"rider": 3})] {
        assert!(!violations(&schema, &wrong).is_empty(), "{wrong}");
    }
}

/// A bicycle in place, with this tilt of the steer axis.
fn inline(lam: f64) -> Value {
    let text = std::fs::read_to_string(repository("data/bicycles.toml")).expect("is there");
    let all: toml::Table = text.parse().expect("TOML");
    let mut parameters = all["rigid_jason"].clone().try_into::<toml::Table>().expect("a set");
    for key in ["source", "note", "rider_included", "schema"] {
        parameters.remove(key);
    }
    parameters.insert("lam".into(), lam.into());
    json!({"name": "mine", "parameters": parameters})
}

/// An example of a text for each setting that differs from its default.
fn example(setting: &Setting) -> String {
    if let Some((word, _)) = setting.words.last() {
        return (*word).into();
    }
    let text = match setting.name {
        "bicycle" => "benchmark",
        "bicycle-set" => "lam=0.3",
        "rider" => "smart",
        "law" => "cl2:3",
        "set" => "limits.rise_nm_s=3",
        "taper" => "0.2:0.4",
        "sensor-delay" | "delay" => "25ms",
        "sensor" => "gyro:noise=0.5",
        "actuator" => "gazelle",
        "fault" => "motor:dead@1s",
        "parameters" => "set.toml",
        "fall" => "flat=none",
        "speeds" => "3:4:0.5",
        "adaptive-speeds" | "recovered-below" | "ray-tolerance" => "0.2",
        _ => "3",
    };
    text.into()
}

/// Situation: every setting of the table that options and axes read.
/// Action: set it in a scenario, and write that as a file.
/// Must hold: the file has the key that the table says, and reads back as the same scenario, also as JSON.
#[test]
fn every_setting_has_its_key() {
    let all = [CONDITIONS, SEARCH, ADAPTIVE, START, PLANE, UNCERTAIN].into_iter().flatten();
    let mut count = 0;
    for setting in all {
        let mut scenario = Scenario::default();
        (setting.set)(&mut scenario, &example(setting)).unwrap_or_else(|e| panic!("{}: {e}", setting.name));
        assert_ne!(scenario, Scenario::default(), "{}", setting.name);
        if setting.key.starts_with("start.") && setting.name != "speed" {
            (START[0].set)(&mut scenario, "4").expect("a speed");
        }
        if setting.key.starts_with("plane.") && setting.name != "speed" {
            (PLANE[0].set)(&mut scenario, "4").expect("a speed");
        }
        let text = scenario.to_toml().expect("can be written");
        let table: toml::Table = text.parse().expect("TOML");
        let found =
            setting.key.split('.').try_fold(toml::Value::Table(table), |value, key| value.get(key).cloned());
        assert!(found.is_some(), "{}: no {} in\n{text}", setting.name, setting.key);
        assert_eq!(Scenario::from_toml(&text).as_ref(), Ok(&scenario), "{text}");
        let json = serde_json::to_string(&scenario).expect("JSON");
        assert_eq!(Scenario::from_json(&json).as_ref(), Ok(&scenario), "{json}");
        count += 1;
    }
    assert!(count > 30, "{count}");
}

proptest! {
    /// Situation: any text, and any change of one byte of a good scenario.
    /// Action: read it as TOML and as JSON.
    /// Must hold: a scenario or an error with words, no panic.
    #[test]
    fn any_text_is_read_or_rejected(text in ".{0,200}", at in 0_usize..400, byte in any::<u8>()) {
        let good = Scenario::read(&repository("data/scenarios/product.toml")).expect("is right").to_toml().expect("TOML");
        let mut changed = good.into_bytes();
        let at = at % changed.len();
        changed[at] = byte;
        for text in [text, String::from_utf8_lossy(&changed).into_owned()] {
            for read in [Scenario::from_toml(&text), Scenario::from_json(&text)] {
                prop_assert!(read.is_ok() || read.is_err_and(|e| !e.to_string().is_empty()));
            }
        }
    }

    /// Situation: settings with any numbers.
    /// Action: write the scenario as TOML and as JSON, and read it.
    /// Must hold: the same bits.
    #[test]
    fn numbers_survive(limit in 0.1_f64..50.0, delay in 0.0_f64..1.0, noise in 0.0_f64..9.0, lam in -1.0_f64..1.4) {
        let mut scenario = Scenario::default();
        for (name, text) in [
            ("torque-limit", limit.to_string()),
            ("sensor-delay", format!("{delay}s")),
            ("sensor", format!("accel:noise={noise}")),
            ("bicycle-set", format!("lam={lam}")),
        ] {
            let setting = CONDITIONS.iter().find(|setting| setting.name == name).expect("is one");
            (setting.set)(&mut scenario, &text).expect("a number");
        }
        prop_assert_eq!(Scenario::from_toml(&scenario.to_toml().expect("TOML")), Ok(scenario.clone()));
        let json = serde_json::to_string(&scenario).expect("JSON");
        prop_assert_eq!(Scenario::from_json(&json), Ok(scenario));
    }
}

/// Situation: the scenarios in the folder of examples.
/// Action: run each with the command in its first line.
/// Must hold: exit code 0, and `--print-scenario` prints a scenario that reads back.
#[test]
fn the_shipped_scenarios_run() {
    let bench = Bench::new(PROGRAM);
    let folder = repository("data/scenarios");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let command = command_of(&path);
        let place = tests::cli::word(&path);
        let run = bench.run(&format!("{command} --scenario {place} --quiet"));
        assert_eq!(run.code, Some(0), "{place}: {}", run.stderr);
        let printed = bench.run(&format!("{command} --scenario {place} --print-scenario")).stdout;
        assert!(Scenario::from_toml(&printed).is_ok(), "{printed}");
        count += 1;
    }
    assert!(count >= 3, "{count}");
}

/// The command in a scenario's first line: `# sim-host COMMAND --scenario FILE: ...`.
fn command_of(path: &Path) -> String {
    let text = std::fs::read_to_string(path).expect("is there");
    let line = text.lines().next().and_then(|line| line.strip_prefix("# sim-host ")).expect("a command");
    line.split(" --scenario").next().expect("a command").into()
}
