//! Interfaces on which scripts rely.

use serde_json::{Value, json};
use sim_host::bicycle::{Geometry, Motion, State, Torques, linear::Linear, pitch_from_upright};
use tests::cli::{Bench, repository, word};
use tests::json_schema::violations;
use tests::rides::shipped;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");
/// A basin that takes a moment.
const QUICK: &str = "basin --speeds 3:5:0.5 --scan-step 2 --max-rate 12 --tolerance 0.5 --time-limit 1.5";

fn committed(name: &str) -> Value {
    let path = repository("docs/schema").join(format!("{name}.json"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Situation: one document of each kind, of a fall and a recovery, with and without limits.
/// Action: compare it with the committed schema, and that with the program's own.
/// Must hold: it is valid; the schemas are the same.
#[test]
fn documents_fit_their_committed_schemas() {
    let bench = Bench::new(PROGRAM);
    let law = repository("data/laws/example.toml");
    let extract = word(&repository("data/recordings/g2_steer_encoder_spikes_2mps.csv"));
    for (name, line) in [
        ("basin", QUICK),
        ("basin", "basin --speeds 6 --law none --scan-step 5 --max-rate 5 --axis roll-rate --time-limit 1"),
        ("ride", "ride --speed 4 --steer-rate 5"),
        ("ride", "ride --speed 1 --steer-rate 25 --preset product --sensor-delay 20ms"),
        ("ride", "ride --speed 0"),
        ("ride", "ride --speed 4 --rider young --gains best"),
        (
            "basin-compare",
            "basin compare a=--rider=smart b=--law=none --speeds 5:6:1 --max-rate 6 --scan-step 1",
        ),
        ("basin-plane", "basin plane --speed 5 --rays 4 --points 4 --ray-tolerance 0.05"),
        ("sweep", "sweep --over law=h,none --speeds 5 --max-rate 6 --scan-step 2 --time-limit 1"),
        ("replay", &format!("replay {extract} --map extract --fault gyro:missing@2s")),
        ("replay", &format!("replay {}", word(&repository("data/border_ride.frames")))),
        ("replay-many", &format!("replay {extract} {extract} --map extract --fault gyro:missing@2s")),
        ("eigen", "eigen --speeds 0:10:1"),
        ("eigen", "eigen --rider smart --law h --speeds 3:4:0.5 --roots 6"),
        ("eigen", &format!("eigen --speeds 4 --law {}", word(&law))),
        ("bicycle-check", "bicycle check"),
        ("bicycle-check", "bicycle check --bicycle yellowrev"),
        ("rider-show", "rider show smart6"),
        ("rider-show", "rider show hess --gains regression"),
    ] {
        assert_eq!(violations(&committed(name), &bench.json(line)), [""; 0], "{line}");
    }
    for name in [
        "basin",
        "ride",
        "replay",
        "replay-many",
        "eigen",
        "bicycle-check",
        "rider-show",
        "thesis",
        "basin-compare",
        "basin-plane",
        "sweep",
        "sweep-status",
    ] {
        let run = bench.run(&format!("schema {name}"));
        let file = std::fs::read_to_string(repository("docs/schema").join(format!("{name}.json"))).unwrap();
        assert!(run.stdout == file, "run: sim-host schema {name} > docs/schema/{name}.json");
    }
}

/// Situation: the documents that `schema` knows.
/// Action: compare their names with the folder of the committed schemas and with docs/cli.md.
/// Must hold: a schema for each document and no other; each name in the row of `schema`.
#[test]
fn every_document_has_a_committed_schema() {
    let help = Bench::new(PROGRAM).run("schema --help").stdout.replace('\n', " ");
    let (_, rest) = help.split_once("[possible values:").unwrap();
    let names: Vec<&str> = rest.split(']').next().unwrap().split(',').map(str::trim).collect();
    let entries = std::fs::read_dir(repository("docs/schema")).unwrap();
    let mut files: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    let mut expected: Vec<String> = names.iter().map(|name| format!("{name}.json")).collect();
    expected.sort();
    files.sort();
    assert_eq!(files, expected);
    let page = std::fs::read_to_string(repository("docs/cli.md")).unwrap();
    let row = page.lines().find(|line| line.starts_with("| `sim-host schema NAME` |")).unwrap();
    for name in names {
        assert!(row.contains(&format!("`{name}`")), "docs/cli.md: {name}");
    }
}

/// Situation: a document that fits, then one with a key missing, added, of a wrong type, or NaN.
/// Action: compare each with the schema.
/// Must hold: every one of the wrong ones is reported.
#[test]
fn the_comparison_with_a_schema_finds_violations() {
    let (schema, right) = (committed("ride"), Bench::new(PROGRAM).json("ride --speed 4"));
    let wrong = |change: &dyn Fn(&mut Value)| {
        let mut document = right.clone();
        change(&mut document);
        violations(&schema, &document).len()
    };
    assert_eq!(wrong(&|_| {}), 0);
    assert_eq!(wrong(&|d| d["extra"] = json!(1)), 1);
    assert_eq!(wrong(&|d| d["outcome"] = json!("flew")), 1);
    assert_eq!(wrong(&|d| d["schema"] = json!(2)), 1);
    assert_eq!(wrong(&|d| d["final"]["roll"] = json!(f64::NAN)), 1);
    assert_eq!(wrong(&|d| drop(d.as_object_mut().unwrap().remove("time_to_fall_s"))), 1);
}

/// Situation: the benchmark bicycle.
/// Action: request its linear model and accelerations, columns in another order.
/// Must hold: the library's numbers to the last bit; 17 digits; the documented header.
#[test]
fn check_and_accel_give_the_librarys_numbers() {
    let bench = Bench::new(PROGRAM);
    let bicycle = shipped("benchmark");
    let linear = Linear::new(&bicycle.parameters);
    let document = bench.json("bicycle check --bicycle benchmark");
    for (name, m) in [("M", linear.m), ("C1", linear.c1), ("K0", linear.k0), ("K2", linear.k2)] {
        assert_eq!(document[name], json!([[m[(0, 0)], m[(0, 1)]], [m[(1, 0)], m[(1, 1)]]]), "{name}");
    }
    let b = Geometry::new(&bicycle.parameters);
    let header = "steer_torque,roll,steer,rear_wheel_rate,roll_rate,steer_rate,roll_torque";
    bench.write("states.csv", format!("{header}\n2, 0.1, -0.2, -15, 0.5, 0.7, -3\n0,0,0,0,0,0,0\n"));
    let answer = bench.run("bicycle accel --bicycle benchmark --states states.csv").stdout;
    let lines: Vec<&str> = answer.lines().collect();
    let (roll, steer) = (0.1, -0.2);
    let pitch = pitch_from_upright(&b, roll, steer).unwrap();
    let state = State { roll, steer, roll_rate: 0.5, steer_rate: 0.7, rear_wheel_rate: -15.0, pitch };
    let a = Motion::new(&b, &state).accelerations(&b, &Torques { roll: -3.0, steer: 2.0 });
    assert_eq!((lines[0], lines.len()), ("roll_acc,steer_acc,rear_wheel_acc", 3));
    let cells: Vec<&str> = lines[1].split(',').collect();
    assert_eq!(cells, [a.roll, a.steer, a.rear_wheel].map(|x| format!("{x:.16e}")));
    assert!(
        cells.iter().all(|c| c.chars().take_while(|c| *c != 'e').filter(char::is_ascii_digit).count() == 17)
    );
}

/// Situation: ranges of speeds whose steps have no exact binary value, and a single speed.
/// Action: request eigenvalues.
/// Must hold: both ends are there, four pairs per speed, largest real part first.
#[test]
fn eigenvalues_of_every_speed_ends_included() {
    let bench = Bench::new(PROGRAM);
    let document = bench.json("eigen --speeds 0:10:0.1");
    let speeds = document["speeds"].as_array().unwrap();
    assert_eq!((speeds.len(), &speeds[3], &speeds[100]), (101, &json!(0.3), &json!(10.0)));
    for four in document["eigenvalues"].as_array().unwrap() {
        let re: Vec<f64> = four.as_array().unwrap().iter().map(|e| e[0].as_f64().unwrap()).collect();
        assert!(re.len() == 4 && re.is_sorted_by(|a, b| a >= b), "{four}");
    }
    assert_eq!(bench.json("eigen --speeds 4")["speeds"], json!([4.0]));
    assert_eq!(bench.json("eigen --speeds 0:1:0.4")["speeds"], json!([0.0, 0.4, 0.8]));
}

/// Situation: a small basin.
/// Action: check the consistency of its parts.
/// Must hold: one value per speed, lower mirrors upper, area by the trapezoidal rule.
#[test]
fn a_basins_parts_fit_together() {
    let document = Bench::new(PROGRAM).json(QUICK);
    let numbers = |v: &Value| v.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect::<Vec<_>>();
    let (speeds, upper) = (numbers(&document["speeds"]), numbers(&document["height"]["upper"]));
    assert_eq!(speeds, [3.0, 3.5, 4.0, 4.5, 5.0]);
    assert_eq!(numbers(&document["height"]["lower"]), upper.iter().map(|u| -u).collect::<Vec<_>>());
    let area: f64 = (1..5).map(|i| 0.25 * (upper[i] + upper[i - 1])).sum();
    assert!((document["area"].as_f64().unwrap() - area).abs() < 1e-12);
    let mean = upper.iter().sum::<f64>() / 5.0;
    assert!((document["mean_height"].as_f64().unwrap() - mean).abs() < 1e-12 && mean > 1.0);
    assert_eq!(document["complete"], json!(true));
    assert_eq!(document["map"]["outcome"].as_array().unwrap().len(), 5);
}

/// Situation: the same search on one thread and on two.
/// Action: compare the documents.
/// Must hold: equal except for the time it took; the text states the threads.
#[test]
fn threads_do_not_change_a_bit() {
    let bench = Bench::new(PROGRAM);
    let [one, two] = [1, 2].map(|n| {
        let mut document = bench.json(&format!("{QUICK} --threads {n}"));
        document["seconds"] = Value::Null;
        document.to_string()
    });
    assert_eq!(one, two);
    for (n, text) in [(1, "on 1 thread)"), (2, "on 2 threads)")] {
        let done = bench.run(&format!("{QUICK} --threads {n}"));
        assert!(done.stdout.contains(text), "{}", done.stdout);
    }
}

/// Situation: one bicycle under its shipped name, out of the collection and from a file of its own.
/// Action: ride each.
/// Must hold: the same parameters, the same end.
#[test]
fn a_bicycle_is_the_same_by_name_collection_and_file() {
    let bench = Bench::new(PROGRAM);
    bench.write("own.toml", bench.run("bicycle show --bicycle rigid_luke").stdout);
    let collection = word(&repository("data/bicycles.toml")) + "#rigid_luke";
    let by = |name: &str| {
        let document = bench.json(&format!("ride --speed 5 --steer-rate 3 --bicycle {name}"));
        (document["config"]["bicycle"]["parameters"].clone(), document["final"].clone())
    };
    let expected = by("rigid_luke");
    assert_eq!(by("own.toml"), expected);
    assert_eq!(by(&collection), expected);
    let example = word(&repository("data/bicycles/example.toml"));
    assert_eq!(by(&example), by("benchmark"));
}
