//! Sweeps: the same bytes however they are computed, without results of another sweep.

use netcdf3::FileReader;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;
use serde_json::Value;
use sim_host::sweep::Axis;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Child, Stdio};

use tests::cli::{Bench, repository};
use tests::draws::runner;
use tests::json_schema::violations;
use tests::wait::until_done;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");
/// Four cells of two columns, coarse and short.
const SMALL: &str = "sweep --over law=h,none --over torque-limit=2,none --speeds 4:5:1 --max-rate 12 \
                     --scan-step 2 --tolerance 0.5 --time-limit 1.5 -q";

/// Every file under a folder, by its path in it.
pub(crate) fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).expect("the folder is there") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        if path.is_dir() {
            found.extend(files(&path).into_iter().map(|(inner, bytes)| (format!("{name}/{inner}"), bytes)));
        } else {
            found.insert(name, std::fs::read(&path).expect("a file"));
        }
    }
    found
}

/// Output of a command that must succeed.
pub(crate) fn must(bench: &Bench, line: &str) -> String {
    let run = bench.run(line);
    assert_eq!(run.code, Some(0), "{line}: {}", run.stderr);
    run.stdout + &run.stderr
}

fn units(bench: &Bench, folder: &str) -> Vec<String> {
    let all = files(&bench.path(folder)).into_keys();
    all.filter(|name| name.starts_with("units/")).map(|name| format!("{folder}/{name}")).collect()
}

/// Situation: two laws with and without a torque limit.
/// Action: sweep; then run `basin` for one of the cells.
/// Must hold: the document is valid; the cell has `basin`'s heights, area and border efforts to the bit; a limit of 2
/// N m is never exceeded and costs area; without assist it changes nothing.
#[test]
fn a_cell_has_the_values_of_basin() {
    let bench = Bench::new(PROGRAM);
    must(&bench, &format!("{SMALL} --out s"));
    let document: Value = serde_json::from_str(&bench.read("s/sweep.json")).unwrap();
    let schema = std::fs::read_to_string(repository("docs/schema/sweep.json")).unwrap();
    assert_eq!(violations(&serde_json::from_str(&schema).unwrap(), &document), [""; 0]);
    let cells = document["cells"].as_array().unwrap();
    let values: Vec<String> = cells.iter().map(|c| c["values"].to_string()).collect();
    assert_eq!(values, [r#"["h","2"]"#, r#"["h","none"]"#, r#"["none","2"]"#, r#"["none","none"]"#]);
    let basin = bench.json(
        "basin --law h --torque-limit 2 --speeds 4:5:1 --max-rate 12 --scan-step 2 --tolerance 0.5 \
         --time-limit 1.5",
    );
    for (i, found) in cells[0]["found"].as_array().unwrap().iter().enumerate() {
        assert_eq!(found["height"], basin["height"]["upper"][i]);
        assert_eq!(found["effort"], basin["border"][i]["effort"]);
    }
    assert_eq!(cells[0]["area"], basin["area"]);
    assert_eq!(cells[0]["config"]["torque_limit_nm"], 2.0);
    assert_eq!(document["config"]["bicycle"], basin["config"]["bicycle"]);
    let number = |i: usize, key: &str| cells[i][key].as_f64().unwrap();
    assert_eq!(number(0, "peak_torque_nm"), 2.0);
    assert!(number(0, "area") < number(1, "area") && number(0, "area") > 0.2 * number(1, "area"));
    assert_eq!((number(2, "area"), number(2, "peak_torque_nm")), (number(3, "area"), 0.0));
}

/// Waits until a cell of the folder is done.
fn wait_for_unit(child: &mut Child, units: &Path) {
    let is_done = |entry: std::fs::DirEntry| entry.path().extension().is_some_and(|x| x == "json");
    until_done(child, "a cell", |_| std::fs::read_dir(units).ok()?.flatten().any(is_done).then_some(()));
}

/// Situation: a sweep of sixty cells.
/// Action: Ctrl-C after the first cells; the same command again; the same at once in another folder.
/// Must hold: exit code 130 with complete cells stored and no results; then the rest alone is computed; both folders
/// have the same bytes.
#[test]
#[cfg(target_os = "linux")]
fn an_interrupted_sweep_resumes_to_the_same_bytes() {
    let bench = Bench::new(PROGRAM);
    let line = "sweep --over torque-limit=0.5:20/log60 --speeds 4:5:0.5 --max-rate 10 --scan-step 1 \
                --tolerance 0.5 --time-limit 1 -q";
    let mut child = bench
        .command(&format!("{line} --out cut"))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    wait_for_unit(&mut child, &bench.path("cut/units"));
    let kill = std::process::Command::new("sh").args(["-c", &format!("kill -INT {}", child.id())]).status();
    assert!(kill.unwrap().success());
    let run = tests::cli::Run::from(child.wait_with_output().unwrap());
    assert_eq!(run.code, Some(130), "{run:?}");
    let stored = units(&bench, "cut");
    assert!(!stored.is_empty() && stored.len() < 60, "{}", stored.len());
    assert!(
        run.stderr.contains(&format!("{} of 60 cells are done and kept", stored.len())),
        "{}",
        run.stderr
    );
    assert!(!bench.path("cut/sweep.json").exists());
    let written = |name: &String| std::fs::metadata(bench.path(name)).unwrap().modified().unwrap();
    let before: Vec<_> = stored.iter().map(written).collect();
    must(&bench, &format!("{line} --out cut"));
    assert_eq!(stored.iter().map(written).collect::<Vec<_>>(), before, "computed again");
    must(&bench, &format!("{line} --out whole --threads 1"));
    assert!(files(&bench.path("cut")) == files(&bench.path("whole")));
}

/// Situation: a sweep, and the same in three shards.
/// Action: merge the shards, given in another order.
/// Must hold: disjoint shards; every file of the merged folder has the bytes of the unsharded one's, figures and
/// NetCDF too; two shards alone are rejected with the missing cells named.
#[test]
fn merged_shards_are_the_whole_to_the_bit() {
    let bench = Bench::new(PROGRAM);
    must(&bench, &format!("{SMALL} --out whole"));
    for i in 1..=3 {
        must(&bench, &format!("{SMALL} --out part{i} --shard {i}/3"));
    }
    let parts: Vec<usize> = (1..=3).map(|i| units(&bench, &format!("part{i}")).len()).collect();
    assert_eq!(parts, [2, 1, 1]);
    bench.run("sweep merge part1 part3 --out merged").rejected_naming(&["1 of 4 cells", "law=", "shards"]);
    assert!(!bench.path("merged").exists());
    must(&bench, "sweep merge part3 part1 part2 --out merged -q");
    let (whole, merged) = (files(&bench.path("whole")), files(&bench.path("merged")));
    let results = ["figures/area-law-torque-limit.svg", "heights.csv", "sweep.csv", "sweep.json", "sweep.nc"];
    assert!(results.iter().all(|name| whole.contains_key(*name)), "{:?}", whole.keys());
    assert!(whole == merged);
}

/// Situation: a finished sweep.
/// Action: change one digit in a cell's file, truncate another's; run again; damage one and merge.
/// Must hold: both are named and computed again, with the same bytes in the end; a merge, which cannot compute, names
/// the file.
#[test]
fn damaged_cells_are_found_and_computed_again() {
    let bench = Bench::new(PROGRAM);
    must(&bench, &format!("{SMALL} --out s"));
    let before = files(&bench.path("s"));
    let damaged = units(&bench, "s");
    let text = bench.read(&damaged[0]);
    let at = text.find("\"rides\": ").unwrap() + 9;
    let digit = if text.as_bytes()[at] == b'1' { "2" } else { "1" };
    let changed = format!("{}{digit}{}", &text[..at], &text[at + 1..]);
    bench.write(&damaged[0], &changed);
    bench.write(&damaged[1], &bench.read(&damaged[1])[..200]);
    let output = must(&bench, &format!("{SMALL} --out s"));
    for name in &damaged[..2] {
        assert!(output.contains(name.strip_prefix("s/").unwrap()), "{output}");
    }
    assert_eq!(output.matches("is damaged: computed again").count(), 2);
    assert!(files(&bench.path("s")) == before);
    bench.write(&damaged[0], &changed);
    bench.run("sweep merge s --out merged").rejected_naming(&[&damaged[0], "damaged"]);
}

/// Situation: folders of other sweeps, of other content, and none.
/// Action: sweep into them, and merge them.
/// Must hold: rejected, with the differences; nothing in them is changed.
#[test]
fn a_folder_with_other_content_is_rejected() {
    let bench = Bench::new(PROGRAM);
    must(&bench, &format!("{SMALL} --out s"));
    let before = files(&bench.path("s"));
    for (change, what) in
        [("--over imu=body", "axes"), ("--imu body", "options"), ("--threads 1 --axis roll-rate", "search")]
    {
        bench.run(&format!("{SMALL} --out s {change}")).rejected_naming(&["s holds another sweep", what]);
    }
    must(&bench, &format!("{SMALL} --imu body --out other"));
    bench.run("sweep merge s other --out both").rejected_naming(&["s and other", "options"]);
    bench.run("sweep merge s nothing").rejected_naming(&["nothing", "plan.json"]);
    std::fs::create_dir(bench.path("full")).unwrap();
    bench.write("full/letter.txt", "");
    bench.run(&format!("{SMALL} --out full")).rejected_naming(&["full", "neither empty"]);
    assert!(files(&bench.path("s")) == before);
}

/// Situation: axes with wrong names and values.
/// Action: sweep.
/// Must hold: the axis, the cell and the value are named, before any file is made.
#[test]
fn wrong_axes_and_values_are_named() {
    let bench = Bench::new(PROGRAM);
    for (options, named) in [
        ("--over torque=1,2", &["--over torque", "--torque", "{torque}", "torque-limit"][..]),
        ("--over law=h,q", &["cell law=q", "unknown law `q`"]),
        ("--over torque-limit=2,70", &["cell torque-limit=70", "--torque-limit", "0.1 to 50"]),
        ("--over sensor-delay=0ms:1ms/3", &["cell sensor-delay=0.5ms", "control periods"]),
        ("--over imu=euler,gyro", &["cell imu=gyro", "gyro", "--imu"]),
        ("--over law=h --over law=f", &["--over law", "twice"]),
        ("--law f --over law=h,g", &["--over law", "in addition"]),
        ("--law cl2:{speed} --over speed=1,2", &["--over speed", "result"]),
        ("--over delay=30ms,60ms", &["cell delay=30ms", "--rider"]),
        ("--over torque-limit=1:20/1000 --over rate-limit=10:1000/1000", &["1000000 cells", "100000"]),
    ] {
        bench.run(&format!("sweep {options}")).rejected_naming(named);
    }
    for options in
        ["", "--over law", "--over torque-limit=2:1:1", "--over law=h --shard 3/2", "--over law=h --speeds x"]
    {
        assert_eq!(bench.run(&format!("sweep {options}")).code, Some(2), "{options}");
    }
    assert_eq!(bench.files(), [""; 0]);
}

/// Situation: a law's parameter, and riders beside none.
/// Action: vary it by its name in braces, and by the law's whole text; vary riders with a delay.
/// Must hold: the same heights; a rider's delay is no error in the cell without a rider.
#[test]
fn a_name_in_braces_is_the_axis() {
    let bench = Bench::new(PROGRAM);
    let quick = "--speeds 4 --max-rate 12 --scan-step 2 --tolerance 1 --time-limit 1";
    let heights = |axes: &str| {
        let document = bench.json(&format!("sweep {axes} {quick} --out {}", axes.len()));
        let cells = document["cells"].as_array().unwrap().clone();
        cells.iter().map(|c| c["found"][0]["height"].as_f64().unwrap()).collect::<Vec<_>>()
    };
    let (inside, whole) = (heights("--law cl2:{k} --over k=0.5,4"), heights("--over law=cl2:0.5,cl2:4"));
    assert_eq!(inside, whole);
    assert!(inside[0] < inside[1], "{inside:?}");
    let ridden = heights("--over rider=none,smart --delay 60ms --law h");
    assert!(ridden.iter().all(|h| (1.0..12.0).contains(h)) && ridden[0] != ridden[1], "{ridden:?}");
}

/// Situation: a sweep that has not begun, and one that is partly done.
/// Action: `--dry-run`.
/// Must hold: every cell of the shard with its state; no file is made.
#[test]
fn a_dry_run_lists_the_cells_and_writes_nothing() {
    let bench = Bench::new(PROGRAM);
    let line = SMALL.replace(" -q", "");
    let output = must(&bench, &format!("{line} --out s --dry-run"));
    assert_eq!(output.matches("to do  law=").count(), 4, "{output}");
    assert!(output.contains("4 of 4 cells to do, 2 speeds each: about "), "{output}");
    assert_eq!(bench.files(), [""; 0]);
    must(&bench, &format!("{line} --out s --shard 1/2 -q"));
    let output = must(&bench, &format!("{line} --out s --dry-run"));
    assert_eq!(
        (output.matches("to do  law=").count(), output.matches("done   law=").count()),
        (2, 2),
        "{output}"
    );
}

/// Situation: axes of numbers with a unit and of texts.
/// Action: sweep, and read the NetCDF file.
/// Must hold: dimensions axes and speed; the axes' values and the document's heights and areas, to the bit; units
/// and names of the options' keys.
#[test]
fn netcdf_has_the_documents_numbers() {
    let bench = Bench::new(PROGRAM);
    let document = bench.json(
        "sweep --over sensor-delay=0ms,40ms --over law=h,cl2:4 --speeds 4:6:1 --max-rate 12 --scan-step 2 \
         --tolerance 0.5 --time-limit 1 --out s",
    );
    let mut file = FileReader::open(bench.path("s/sweep.nc")).unwrap();
    let set = file.data_set();
    let dims: Vec<usize> =
        ["sensor_delay", "law", "speed"].iter().map(|d| set.dim_size(d).unwrap()).collect();
    assert_eq!(dims, [2, 2, 3]);
    assert_eq!(set.get_var("height").unwrap().dim_names(), ["sensor_delay", "law", "speed"]);
    assert_eq!(set.get_var("area").unwrap().dim_names(), ["sensor_delay", "law"]);
    let units = |name: &str| set.get_var_attr_as_string(name, "units").unwrap();
    assert_eq!((units("sensor_delay"), units("height")), ("ms".into(), "rad s-1".into()));
    let about = |name: &str| set.get_var_attr_as_string(name, "long_name").unwrap();
    assert_eq!(
        (about("sensor_delay"), about("law")),
        ("delay of the sensors".into(), "roll-rate law".into())
    );
    let configuration = set.get_global_attr_as_string("configuration").unwrap();
    let configuration: Value = serde_json::from_str(&configuration).unwrap();
    assert_eq!(configuration["tool"], document["tool"]);
    assert_eq!(configuration["search"], document["search"]);
    assert_eq!(file.read_var_f64("sensor_delay").unwrap(), [0.0, 40.0]);
    assert_eq!(file.read_var_u8("law").unwrap(), b"h\0\0\0\0cl2:4");
    let cells = document["cells"].as_array().unwrap();
    let areas: Vec<f64> = cells.iter().map(|c| c["area"].as_f64().unwrap()).collect();
    let found = cells.iter().flat_map(|c| c["found"].as_array().unwrap());
    let heights: Vec<f64> = found.map(|f| f["height"].as_f64().unwrap()).collect();
    assert_eq!(file.read_var_f64("area").unwrap(), areas);
    assert_eq!(file.read_var_f64("height").unwrap(), heights);
}

/// Situation: texts made of the characters of ranges.
/// Action: parse them as an axis.
/// Must hold: no panic; values without repetition, or an error that names the key.
#[test]
fn any_text_is_an_axis_or_a_reason() {
    let word =
        vec(select(&['0', '1', '9', ':', ':', '.', '-', 'e', '/', 'l', 'o', 'g', 'm', 's', ','][..]), 0..14);
    let text = prop_oneof![word.prop_map(|w| w.into_iter().collect::<String>()), any::<String>()];
    runner(4000)
        .run(&text, |text| {
            match Axis::parse(&format!("key={text}")) {
                Ok(axis) => {
                    let mut values = axis.values.clone();
                    values.sort();
                    values.dedup();
                    prop_assert_eq!(values.len(), axis.values.len());
                    prop_assert!(!values.is_empty() && values.iter().all(|v| !v.is_empty()));
                }
                Err(e) => prop_assert!(e.to_string().contains("key"), "{e}"),
            }
            Ok(())
        })
        .unwrap();
}

/// Situation: ranges of N values, even and logarithmic, with and without a unit.
/// Action: parse them.
/// Must hold: N rising values, both ends exact, steps or ratios equal within rounding.
#[test]
fn ranges_of_n_values_are_even() {
    let range = (0.01..10.0_f64, 1.5..100.0_f64, 2..40_usize, any::<bool>(), select(&["", "ms"][..]));
    runner(1000)
        .run(&range, |(from, factor, n, log, unit)| {
            let to = from * factor;
            let kind = if log { "log" } else { "" };
            let axis = Axis::parse(&format!("k={from}{unit}:{to}{unit}/{kind}{n}")).unwrap();
            let (x, found_unit) = axis.numbers().unwrap();
            prop_assert_eq!((x.len(), found_unit), (n, unit));
            prop_assert_eq!((x[0], x[n - 1]), (from, to));
            for pair in x.windows(2) {
                let (step, expected) = if log {
                    (pair[1] / pair[0], factor.powf(1.0 / (n - 1) as f64))
                } else {
                    (pair[1] - pair[0], (to - from) / (n - 1) as f64)
                };
                prop_assert!((step / expected - 1.0).abs() < 2e-3, "{pair:?}");
            }
            Ok(())
        })
        .unwrap();
}
