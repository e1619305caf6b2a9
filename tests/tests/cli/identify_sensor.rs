//! `sim-host identify sensor`, and its files in `--sensor`.

use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use tests::cli::{Bench, repository, word};
use tests::json_schema::violations;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

fn plant(bench: &Bench, options: &str) -> Value {
    bench.json(&format!("ride --preset product --speed 4 --time-limit 0.5 {options}"))["config"]["plant"]["sensors"]
        .clone()
}

/// Situation: a shipped recording.
/// Action: fit two sensors, write document, table and model, ride with the model.
/// Must hold: the document is valid; the period of 5 ms and the step of the file's digits are found; quantities that
/// cannot be estimated are named; the ride has the model's numbers.
#[test]
fn a_model_is_fitted_written_and_ridden_with() {
    let bench = Bench::new(PROGRAM);
    let file = word(&repository("data/recordings/g1_steer_encoder_dies_4mps.csv"));
    let line = format!(
        "identify sensor {file} --map robot-bicycle --sensor gyro --sensor steer --source here --licence free"
    );
    let document = bench.json(&format!("{line} --csv o.csv --out o.toml"));
    let schema = std::fs::read_to_string(repository("docs/schema/identify-sensor.json")).expect("a schema");
    let committed: Value = serde_json::from_str(&schema).expect("JSON");
    assert_eq!(violations(&committed, &document), [""; 0]);
    let own = bench.run("schema identify-sensor").stdout;
    assert!(own == schema, "run: sim-host schema identify-sensor > docs/schema/identify-sensor.json");
    let steer = &document["sensors"]["steer"];
    assert_eq!((&steer["period_s"], &steer["quantum"]), (&json!(0.005), &json!([0.0001])));
    let left_out = steer["left_out"].to_string();
    assert!(
        ["lag: ", "noise, bias and walk: ", "vibration: "].iter().all(|what| left_out.contains(what)),
        "{left_out}"
    );
    assert!(bench.read("o.csv").lines().any(|line| line.starts_with("steer,step between values,,rad,")));
    let text = bench.read("o.toml");
    assert!(
        text.contains("g1_steer_encoder_dies_4mps.csv --map robot-bicycle --sensor gyro --sensor steer\""),
        "{text}"
    );
    let ridden = plant(&bench, "--sensor o.toml");
    assert_eq!(ridden["steer"]["every_ticks"], json!(5));
    assert_eq!(ridden["steer"]["fitted"]["quantum"][0], json!(0.0001));
    assert!(bench.run(&line).stdout.contains("95 % interval"));
}

/// Situation: models by name, joined, of one sensor only, changed, exact.
/// Must hold: each sensor has the last given model; the others are exact; a ride repeats, and differs with another
/// seed.
#[test]
fn models_are_taken_by_name() {
    let bench = Bench::new(PROGRAM);
    assert_eq!(plant(&bench, "--sensor exact"), json!({}));
    let both = plant(&bench, "--sensor mpu6050-robot+hall-16");
    let names: Vec<&String> = both.as_object().expect("sensors").keys().collect();
    assert_eq!(names, ["accel", "front-wheel", "gyro", "rear-wheel"]);
    assert_eq!((&both["gyro"]["every_ticks"], &both["gyro"]["noise"]), (&json!(5), &json!(0.0)));
    assert_eq!(both["rear-wheel"]["fitted"]["pulses_per_turn"], json!(16));
    let one = plant(&bench, "--sensor rear-wheel:model=wheel-can,delay=20ms --sensor gyro:noise=0.01");
    assert_eq!(one.as_object().map(serde_json::Map::len), Some(2));
    let wheel = &one["rear-wheel"];
    assert_eq!((&wheel["every_ticks"], &wheel["delay_ticks"]), (&json!(10), &json!(20)));
    assert_eq!(
        plant(&bench, "--sensor mpu6050-robot --sensor gyro:model=exact --sensor accel:model=exact"),
        json!({})
    );
    let end = |seed: u32| {
        bench.json(&format!(
            "ride --preset product --speed 4 --steer-rate 1 --sensor fused-imu-can --seed {seed}"
        ))["final"]
            .clone()
    };
    assert_eq!(end(1), end(1));
    assert_ne!(end(1), end(2));
    let swept = bench.json(
        "sweep --preset product --over sensor=exact,mpu6050-robot --speeds 4 --max-rate 4 --scan-step 2 --time-limit 1",
    );
    assert_eq!(swept["cells"].as_array().map(Vec::len), Some(2));
}

/// Situation: models, recordings and sensors that do not exist or are wrong.
/// Must hold: exit code 1, or 2 for the use; the error and the available names are printed.
#[test]
fn wrong_models_are_named() {
    let bench = Bench::new(PROGRAM);
    bench.write("bad.toml", "source = \"s\"\nlicence = \"l\"\ncommand = \"c\"\n[gyro]\nrepeat = 2\n");
    bench.write("ride.csv", "t,gx,gy,gz,rear\n0,0,0,0,1\n0.01,0,0,0,1\n0.02,0,0,0,1\n");
    let ride = "ride --speed 4 --sensor";
    let identify = "identify sensor ride.csv --map extract --sensor";
    for (line, code, says) in [
        (format!("{ride} mpu9999"), 1, &["--sensor mpu9999", "exact", "mpu6050-robot"][..]),
        (format!("{ride} bad.toml"), 1, &["bad.toml: gyro: repeat = 2", "0 to 0.999"]),
        (format!("{ride} steer:model=mpu6050-robot"), 1, &["no table steer", "gyro, accel"]),
        (format!("{ride} gyro:model=nothing"), 1, &["unknown sensor model `nothing`", "hall-16"]),
        (format!("{ride} gyro.x:model=mpu6050-robot"), 1, &["only bias"]),
        (format!("{identify} steer"), 1, &["none of the recordings has steer"]),
        (format!("{identify} path"), 2, &["expected one of gyro"]),
        (format!("{identify} gyro --distance way"), 1, &["ride.csv", "way", "no such column"]),
        (format!("{identify} gyro --sensor gyro"), 1, &["--sensor gyro", "already"]),
        (format!("{identify} gyro --svg o.svg"), 1, &["--svg", "no figure"]),
        (format!("{identify} gyro --out o --csv o"), 1, &["--csv and --out"]),
        ("identify sensor none.csv --sensor gyro".into(), 1, &["none.csv"]),
    ] {
        let run = bench.run(&line);
        assert_eq!(run.code, Some(code), "{line}: {}", run.stderr);
        assert!(says.iter().all(|word| run.stderr.contains(word)), "{line}: {}", run.stderr);
    }
    let short = bench.run(&format!("{identify} gyro"));
    assert!(short.code == Some(0) && short.stdout.contains("left out: "), "{short:?}");
}

/// The file of a name, somewhere below a folder.
fn below(folder: &Path, name: &str) -> Option<PathBuf> {
    let entries = std::fs::read_dir(folder).ok()?.filter_map(|entry| Some(entry.ok()?.path()));
    let mut paths: Vec<PathBuf> = entries.collect();
    paths.sort();
    paths.iter().find_map(|path| match path.is_dir() {
        true => below(path, name),
        false => (path.file_name()? == name).then(|| path.clone()),
    })
}

/// Situation: the shipped models, where the recordings are available, below the folder that
/// `STEER_ASSIST_SENSOR_RECORDINGS` names.
/// Action: run the command of each again.
/// Must hold: the same file, to the byte.
#[test]
fn shipped_models_are_made_again() {
    let folder = std::env::var_os("STEER_ASSIST_SENSOR_RECORDINGS").map(PathBuf::from).filter(|f| f.is_dir());
    let Some(folder) = folder else {
        println!("skipped: STEER_ASSIST_SENSOR_RECORDINGS names no folder of recordings (docs/testing.md)");
        return;
    };
    let bench = Bench::new(PROGRAM);
    let mut made = 0;
    for entry in std::fs::read_dir(repository("data/sensors")).expect("a folder") {
        let path = entry.expect("an entry").path();
        let text = std::fs::read_to_string(&path).expect("text");
        let model: toml::Table = toml::from_str(&text).expect("TOML");
        let of = |key: &str| model[key].as_str().expect("text").to_owned();
        let Some(command) = of("command").strip_prefix("sim-host ").map(str::to_owned) else { continue };
        let found = |name: &str| match name.contains(".csv") {
            true => word(&below(&folder, name).unwrap_or_else(|| panic!("{name} is not there"))),
            false => name.to_owned(),
        };
        let texts: Vec<String> = command.split(' ').map(found).collect();
        let options = [("--source", of("source")), ("--licence", of("licence"))];
        let status = bench
            .command(&texts.join(" "))
            .args(options.iter().flat_map(|(option, text)| [*option, text.as_str()]))
            .args(["--out", "again.toml", "--quiet"])
            .status()
            .expect("the program runs");
        assert!(status.success(), "{}", path.display());
        assert!(bench.read("again.toml") == text, "{} is made anew", path.display());
        made += 1;
    }
    assert!(made >= 6, "{made}");
}
