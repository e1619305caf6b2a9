//! The value `none`, where a value is optional: accepted, or rejected with the reason.

use tests::cli::Bench;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

/// Situation: the product's limits, whose rider override needs a largest torque.
/// Action: switch the largest torque off by its parameter, alone and with the override off; give infinity.
/// Must hold: alone it is rejected by its own name with the parameter that needs it, not as infinity nor by an option
/// that was not given; with the override off it is ridden; infinity is no number.
#[test]
fn a_required_torque_limit_names_its_user() {
    let bench = Bench::new(PROGRAM);
    let ride = "ride --preset product --speed 4 --time-limit 0.1 --set limits.max_torque_nm=none";
    let rejected = bench.run(ride);
    rejected.rejected_naming(&["limits.max_torque_nm = none", "limits.rider_torque", "0.1 to 50"]);
    assert!(
        !rejected.stderr.contains("inf") && !rejected.stderr.contains("--torque-limit"),
        "{}",
        rejected.stderr
    );
    assert_eq!(bench.run(&format!("{ride} --set limits.rider_torque=off")).code, Some(0));
    bench.run("ride --speed 4 --set limits.max_torque_nm=inf").rejected_naming(&["`inf` is not a number"]);
}

/// Situation: a sweep of faults and one of sensors, each with its reference cell.
/// Action: sweep; ride with `none` alone.
/// Must hold: the reference's heights are those without the option; the same text in `ride`.
#[test]
fn a_sweep_of_faults_has_a_reference() {
    let bench = Bench::new(PROGRAM);
    let search = "--law h --speeds 4:5:1 --scan-step 2 --tolerance 0.5 --max-rate 12 --time-limit 3";
    let run = bench.run(&format!(
        "sweep {search} --over fault=gyro:stuck@100ms,none --over sensor=gyro:delay=20ms,none --out s"
    ));
    assert_eq!(run.code, Some(0), "{run:?}");
    let cells: serde_json::Value = serde_json::from_str(&bench.read("s/sweep.json")).expect("JSON");
    let basin = bench.json(&format!("basin {search}"));
    let (stuck, reference) = (&cells["cells"][1], &cells["cells"][3]);
    assert_eq!(
        (reference["values"][0].as_str(), reference["values"][1].as_str()),
        (Some("none"), Some("none"))
    );
    assert_eq!(reference["area"], basin["area"]);
    assert!(stuck["area"].as_f64() < Some(0.2 * basin["area"].as_f64().expect("an area")), "{stuck}");
    assert_eq!(bench.run("ride --speed 4 --time-limit 0.1 --fault none --sensor none").code, Some(0));
}

/// Situation: a bicycle of a collection as a value of an axis, `FILE#NAME`.
/// Action: sweep; read the tables as a program that treats `#` as a comment.
/// Must hold: every value with a `#` is quoted.
#[test]
fn a_value_with_a_hash_is_quoted() {
    let bench = Bench::new(PROGRAM);
    bench.write("b.toml", std::fs::read(tests::cli::repository("data/bicycles.toml")).expect("ships"));
    let run = bench.run("sweep --speeds 4 --scan-step 4 --tolerance 1 --max-rate 8 --time-limit 0.5 --over bicycle=b.toml#browser_jason,benchmark --out s");
    assert_eq!(run.code, Some(0), "{run:?}");
    for file in ["s/sweep.csv", "s/heights.csv"] {
        let rows = bench.read(file);
        assert!(rows.lines().nth(3).expect("a row").starts_with("\"b.toml#browser_jason\","), "{rows}");
    }
}

/// Situation: eight shards of one sweep, and a temporary file of one that was killed, in one folder.
/// Action: start all at once.
/// Must hold: each does its part, and the last writes the results; a folder with other content is rejected.
#[test]
fn shards_that_start_together_share_a_folder() {
    let bench = Bench::new(PROGRAM);
    std::fs::create_dir(bench.path("s")).expect("a folder");
    bench.write("s/.sim-host-killed.tmp", "{");
    let line = "sweep --law h --over torque-limit=1:8/8 --speeds 4 --scan-step 4 --tolerance 1 --max-rate 8 --time-limit 0.3 --threads 1 -q";
    let start = |i| bench.command(&format!("{line} --out s --shard {i}/8")).spawn().expect("starts");
    let shards: Vec<_> = (1..=8).map(start).collect();
    for mut shard in shards {
        assert_eq!(shard.wait().expect("ends").code(), Some(0));
    }
    assert!(bench.path("s/sweep.json").exists());
    std::fs::create_dir(bench.path("other")).expect("a folder");
    bench.write("other/notes", "mine");
    bench
        .run(&format!("{line} --out other"))
        .rejected_naming(&["other is neither empty nor the folder of a sweep"]);
}
