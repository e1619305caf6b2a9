//! Users' files: parameters as BicycleParameters and others write them, uncertainties, a rider's body; a file's
//! remarks on its bicycle are preserved.

use serde_json::Value;
use sim_host::bicycle::{KEYS, catalogue};
use tests::cli::{Bench, repository};

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

/// The bench with the package's files in `data`.
fn bench() -> Bench {
    let bench = Bench::new(PROGRAM);
    std::os::unix::fs::symlink(repository("tests/data/bicycleparameters"), bench.path("data"))
        .expect("a link");
    bench
}

fn near(a: &Value, b: f64, part: f64) -> bool {
    a.as_f64().is_some_and(|a| (a - b).abs() <= part * b.abs().max(1e-3))
}

/// Situation: the measured bicycle Rigid and the rider Jason of BicycleParameters, in the package's folders.
/// Action: check them together, by folder and name, by file and name, and by two files.
/// Must hold: the values of the shipped `rigid_jason`, which the package combined; standard deviations as of the
/// Python package `uncertainties` 3.2; parts of the fork reported as not used; a rider's body.
#[test]
fn a_measured_bicycle_and_its_rider_are_combined() {
    let bench = bench();
    let shipped = catalogue::load("rigid_jason").expect("ships").parameters.to_values();
    let (bicycle, rider) = ("data/bicycles/Rigid", "data/riders/Jason/Parameters/JasonRigidBenchmark.txt");
    let file = format!("{bicycle}/Parameters/RigidBenchmark.txt");
    for name in [format!("{bicycle}+Jason"), format!("{file}+Jason"), format!("{file}+{rider}")] {
        let found = bench.json(&format!("bicycle check --bicycle {name}"));
        let bicycle = &found["bicycle"];
        for (key, value) in KEYS.iter().zip(shipped) {
            assert!(
                near(&bicycle["parameters"][key], value, 1e-9),
                "{key}: {} {value}",
                bicycle["parameters"][key]
            );
        }
        for (key, sd) in [
            ("mB", 0.010),
            ("xB", 0.0014854658794505853),
            ("zB", 0.001025986272578155),
            ("IBxx", 0.06453967934939966),
            ("IBxz", 0.046128993922050755),
            ("IByy", 0.06479110702956326),
            ("IBzz", 0.019900694430651907),
            ("w", 0.000166142163674),
        ] {
            assert!(
                near(&bicycle["uncertainties"][key], sd, 0.01),
                "{key}: {}",
                bicycle["uncertainties"][key]
            );
        }
        assert_eq!(
            (&bicycle["rider_included"], &bicycle["warnings"]),
            (&true.into(), &serde_json::json!([]))
        );
        assert!(bicycle["note"].as_str().is_some_and(|note| note.contains("not used: IGxx")), "{bicycle}");
        assert!(bicycle["source"].as_str().is_some_and(|source| source.contains(rider)), "{bicycle}");
    }
    let yaml = bench.json("bicycle check --bicycle data/sets/benchmark-realizedopttwo.yml");
    assert_eq!(
        (&yaml["bicycle"]["parameters"]["c"], &yaml["bicycle"]["note"]),
        (&0.75461.into(), &"not used: v".into())
    );
    let shown = bench.run(&format!("bicycle show --bicycle {bicycle}+Jason"));
    bench.write("shown.toml", &shown.stdout);
    let again = bench.json("bicycle check --bicycle shown.toml");
    assert_eq!(again["bicycle"]["rider_included"], true);
    assert!(near(&again["bicycle"]["uncertainties"]["IBxx"], 0.06454, 0.01), "{}", shown.stdout);
}

/// Situation: files of other programs with one error each.
/// Action: check them.
/// Must hold: rejected with file, line or key and the reason.
#[test]
fn errors_in_files_of_other_programs_are_named() {
    let bench = bench();
    let rigid = bench.read("data/bicycles/Rigid/Parameters/RigidBenchmark.txt");
    for (from, to, named) in [
        ("mB = 22.9+/-0.01", "mB = 22.9+/-", &["my.txt", "line 24", "mB"][..]),
        ("mB = 22.9+/-0.01", "mB 22.9", &["my.txt", "line 24", "KEY = VALUE"]),
        ("mB = 22.9+/-0.01", "mB = 22.9\nmB = 23", &["my.txt", "line 25", "twice"]),
        ("mB = 22.9+/-0.01", "mB = 22.9+/--1", &["my.txt", "line 24", "0 or more"]),
        ("mB = 22.9+/-0.01", "", &["my.txt", "`mB` is missing"]),
        ("mB = 22.9+/-0.01", "mB = 22.9\nmD = 3", &["my.txt", "body `D`", "B, F, H and R"]),
        ("mG = 3.35+/-0.01", "mG = 9.35+/-0.01", &["my.txt", "mG = 9.35", "mH = 5.4"]),
        ("mB = 22.9+/-0.01", "mB = 22.9\nmistake = 1", &["my.txt", "`mistake`"]),
    ] {
        assert!(rigid.contains(from));
        bench.write("my.txt", rigid.replace(from, to));
        bench.run("bicycle check --bicycle my.txt").rejected_naming(named);
    }
    bench.write("round.txt", rigid.clone() + "IFzz = 0.06\nyB = 0.02\n");
    let doubtful = bench.run("bicycle check --bicycle round.txt");
    assert!(
        doubtful.stderr.contains("IFzz = 0.06 is not IFxx") && doubtful.stderr.contains("yB = 0.02"),
        "{doubtful:?}"
    );
    let rider = "data/riders/Jason/Parameters/JasonRigidBenchmark.txt";
    bench
        .run(&format!("bicycle check --bicycle {rider}"))
        .rejected_naming(&["rider's body alone", "BICYCLE+FILE"]);
    bench
        .run("bicycle check --bicycle data/bicycles/Rigid+Luke")
        .rejected_naming(&["data/riders/Luke/Parameters/LukeRigidBenchmark.txt"]);
    bench
        .run(&format!("bicycle check --bicycle rigid_jason+{rider}"))
        .rejected_naming(&["has a rider already"]);
    bench.write("p.yml", "parameterization: principal\nvalues:\n  w: 1.0\n");
    bench
        .run("bicycle check --bicycle p.yml")
        .rejected_naming(&["p.yml has parameterization `principal`", "benchmark"]);
    bench.write("q.yml", "w: [1.0\n");
    bench.run("bicycle check --bicycle q.yml").rejected_naming(&["q.yml", "YAML"]);
}

/// Situation: a set as BicycleParameters' `to_yaml` writes it, with empty remarks and its other name for the same 26
/// parameters; the same in JSON, flat and below `values`.
/// Action: check them.
/// Must hold: the shipped values; no statement on a rider's body, as the file has none; no empty note.
#[test]
fn sets_as_bicycleparameters_writes_them() {
    let bench = bench();
    let values = catalogue::load("benchmark").expect("ships").parameters.to_values();
    let lines = |line: &dyn Fn(&str, f64) -> String| -> Vec<String> {
        KEYS.iter().zip(values).map(|(key, value)| line(key, value)).collect()
    };
    let yaml = lines(&|key, value| format!("  {key}: {value:?}\n")).concat();
    let head = "description: ''\nparameterization: Meijaard2007\nparameters: ''\nrider: null\nvalues:\n";
    bench.write("my.yml", format!("{head}{yaml}  v: 1.0\n"));
    let json = lines(&|key, value| format!("\"{key}\": {value:?}")).join(", ");
    bench.write("flat.json", format!("{{{json}}}\n"));
    bench.write(
        "set.json",
        format!("{{\"rider\": null, \"parameterization\": \"benchmark\", \"values\": {{{json}}}}}\n"),
    );
    for (file, note) in
        [("my.yml", "not used: v".into()), ("flat.json", Value::Null), ("set.json", Value::Null)]
    {
        let bicycle = &bench.json(&format!("bicycle check --bicycle {file}"))["bicycle"];
        for (key, value) in KEYS.iter().zip(values) {
            assert_eq!(bicycle["parameters"][key], value, "{file} {key}");
        }
        assert_eq!((&bicycle["note"], &bicycle["rider_included"]), (&note, &Value::Null), "{file}");
    }
    bench.write("cut.json", format!("{{{json}"));
    bench.run("bicycle check --bicycle cut.json").rejected_naming(&["cut.json", "JSON"]);
}

/// Situation: a measured bicycle with its rider, and a shipped one.
/// Action: show them for BicycleParameters, one with a parameter changed; read that again.
/// Must hold: every line is a remark or a key, `=`, a number and perhaps its deviation, as that package's reader
/// requires; the same values and deviations are read.
#[test]
fn a_bicycle_is_written_for_bicycleparameters() {
    let bench = bench();
    for name in ["data/bicycles/Rigid+Jason", "browser --bicycle-set lam=0.4"] {
        let shown = bench.run(&format!("bicycle show --ini --bicycle {name}")).stdout;
        let lines: Vec<&str> = shown.lines().filter(|line| !line.starts_with('#')).collect();
        assert_eq!(lines.len(), KEYS.len(), "{shown}");
        for line in lines {
            let value = line.split_once(" = ").expect("KEY = VALUE").1;
            assert!(value.split("+/-").all(|number| number.parse::<f64>().is_ok()), "{line}");
        }
        bench.write("shown.txt", &shown);
        let [before, after] =
            [name, "shown.txt"].map(|name| bench.json(&format!("bicycle check --bicycle {name}")));
        assert_eq!(
            (&before["bicycle"]["parameters"], &before["v_w"]),
            (&after["bicycle"]["parameters"], &after["v_w"])
        );
        let [before, after] = [&before, &after].map(|of| of["bicycle"]["uncertainties"].as_object().unwrap());
        assert_eq!(before.len(), after.len(), "{name}");
        for (key, sd) in before {
            assert!(near(&after[key], sd.as_f64().unwrap(), 1e-9), "{name} {key}: {sd} {}", after[key]);
        }
    }
}

/// Situation: bicycles without a rider's body and with one; riders whose gains are made for a bicycle.
/// Action: ride, sweep and compute eigenvalues with a rider.
/// Must hold: a warning that names both, in the output and in the results; none where they belong together; `show`
/// and `check` report whether there is a rider's body.
#[test]
fn a_rider_on_another_bicycle_causes_a_warning() {
    let bench = bench();
    let ride = "--speed 4 --steer-rate 0.1 --time-limit 0.1 --json";
    for (bicycle, rider, warned) in [
        ("browser", "young", &["browser", "rider_included = false", "young"][..]),
        ("browser_jason", "young", &[]),
        ("rigid_jason", "hess", &[]),
        ("browser_jason", "hess", &["hess", "rigid_jason", "browser_jason"]),
        ("data/bicycles/Rigid", "young", &["22.9 kg", "young"]),
        ("data/bicycles/Rigid+Jason", "young", &[]),
    ] {
        for line in [format!("ride {ride}"), "eigen --speeds 4:5:1 --json".into()] {
            let run = bench.run(&format!("{line} --bicycle {bicycle} --rider {rider}"));
            let document: Value = serde_json::from_str(&run.stdout).expect("JSON");
            let at = if line.starts_with("ride") {
                &document["config"]["warnings"]
            } else {
                &document["warnings"]
            };
            let output: Vec<&str> = at.as_array().expect("a list").iter().filter_map(Value::as_str).collect();
            assert_eq!(output.is_empty(), warned.is_empty(), "{bicycle} {rider}: {output:?}");
            let all = output.join(" ");
            assert!(
                warned.iter().all(|word| all.contains(word) && run.stderr.contains(word)),
                "{all} {}",
                run.stderr
            );
        }
    }
    let table = bench.run("ride --bicycle browser --rider young --speed 4 --time-limit 0.1 --csv -").stdout;
    assert!(table.lines().nth(1).expect("the heading").contains("rider_included = false"), "{table}");
    assert!(bench.run("bicycle show --bicycle browser").stdout.contains("\nrider_included = false\n"));
    assert!(bench.run("bicycle check --bicycle browser").stdout.contains("without a rider's body"));
}

/// Situation: a measured bicycle with uncertainties; one without.
/// Action: its basin with 20 draws, twice and with another seed; the other with draws.
/// Must hold: a band around the basin in document, table and figure, the same with the same seed; the other is
/// rejected.
#[test]
fn uncertainties_are_a_band_around_the_basin() {
    let bench = bench();
    let line = "basin --bicycle data/bicycles/Rigid+Jason --law h --speeds 4:5:1 --scan-step 1 --tolerance 0.05 --time-limit 1.5";
    let run = bench.run(&format!("{line} --uncertain 20 --json a.json --csv a.csv --svg a.svg"));
    assert!(run.code == Some(0) && run.stdout.contains("area of 20 drawn bicycles: 5 % "), "{run:?}");
    let first: Value = serde_json::from_str(&bench.read("a.json")).expect("JSON");
    let band = &first["uncertain"];
    for (i, speed) in band["upper"].as_array().expect("per speed").iter().enumerate() {
        let [low, middle, high] = [0, 1, 2].map(|q| speed[q].as_f64().expect("a number"));
        let measured = first["height"]["upper"][i].as_f64().expect("a height");
        assert!(low < middle && middle < high && high - low < 0.2 * measured, "{speed}");
        assert!(low - 0.2 < measured && measured < high + 0.2, "{measured} {speed}");
    }
    assert!(
        bench.read("a.csv").contains("border-95%")
            && bench.read("a.svg").contains("5 % to 95 % of 20 drawn bicycles")
    );
    let heights = |line: &str| bench.json(line)["uncertain"]["heights"].clone();
    assert_eq!(heights(&format!("{line} --uncertain 20 --threads 1")), band["heights"]);
    assert_ne!(heights(&format!("{line} --uncertain 20 --seed 2")), band["heights"]);
    bench.run("basin --uncertain 20").rejected_naming(&[
        "--uncertain",
        "rigid_jason",
        "has no uncertainties",
    ]);
}

/// Situation: the parameters of Rigid with Jason.
/// Action: draw 4000 bicycles.
/// Must hold: means and standard deviations are the files', to first order, within the statistical error of 4000
/// draws.
#[test]
fn draws_have_the_files_spread() {
    let folder = repository("tests/data/bicycleparameters/bicycles/Rigid+Jason");
    let measured =
        catalogue::load(&folder.display().to_string()).expect("loads").measured.expect("uncertain");
    let draws: Vec<[f64; 26]> = (0..4000).map(|i| measured.draw(1, i).expect("exists").to_values()).collect();
    let (middle, deviations) = (measured.parameters().to_values(), measured.deviations());
    for (i, key) in KEYS.iter().enumerate() {
        let mean = draws.iter().map(|d| d[i]).sum::<f64>() / 4000.0;
        let sd = (draws.iter().map(|d| (d[i] - mean).powi(2)).sum::<f64>() / 3999.0).sqrt();
        assert!(
            (mean - middle[i]).abs() <= 5.0 * deviations[i] / 4000_f64.sqrt(),
            "{key}: {mean} {}",
            middle[i]
        );
        assert!(
            (sd / deviations[i] - 1.0).abs() < 0.06 || deviations[i] == 0.0,
            "{key}: {sd} {}",
            deviations[i]
        );
    }
}

/// Situation: files of a bicycle in three formats.
/// Action: cut each at every byte.
/// Must hold: rejected with its name; or all its values are unchanged, or a warning is given.
#[test]
fn a_cut_file_is_no_bicycle_with_less() {
    let bench = bench();
    for (file, name) in [
        ("data/bicycles/Rigid/Parameters/RigidBenchmark.txt", "cut.txt"),
        ("data/sets/benchmark-realizedopttwo.yml", "cut.yml"),
    ] {
        let text = bench.read(file);
        let whole = catalogue::load(&bench.path(file).display().to_string()).expect("loads");
        for at in 0..text.len() {
            bench.write(name, &text[..at]);
            match catalogue::load(&bench.path(name).display().to_string()) {
                Err(error) => assert!(error.to_string().contains(name), "{error}"),
                Ok(cut) if cut.parameters == whole.parameters && cut.measured == whole.measured => {}
                Ok(cut) => {
                    assert!(cut.warnings.iter().any(|w| w.contains("last line has no end")), "byte {at}")
                }
            }
        }
    }
}

/// Situation: shipped and measured bicycles.
/// Action: change a parameter of each, wrongly too; sweep one.
/// Must hold: the changed value, and no other, in the results, whose name contains it; wrong ones are named.
#[test]
fn one_parameter_is_changed_by_name() {
    let bench = bench();
    let eigen = |line: &str| bench.json(&format!("eigen --speeds 4:5:1 {line}"));
    let (plain, changed) = (eigen(""), eigen("--bicycle-set lam=0.3 --bicycle-set c=0.05"));
    let values =
        |document: &Value| document["bicycle"]["parameters"].as_object().expect("parameters").clone();
    let (before, after) = (values(&plain), values(&changed));
    let differing: Vec<&String> = before.keys().filter(|key| before[*key] != after[*key]).collect();
    assert_eq!(
        (differing, &after["lam"], &after["c"]),
        (
            ["c", "lam"].iter().map(|k| before.get_key_value(*k).expect("a key").0).collect(),
            &0.3.into(),
            &0.05.into()
        )
    );
    assert_eq!(changed["bicycle"]["name"], "rigid_jason with c=0.05, lam=0.3");
    let rigid = "--bicycle data/bicycles/Rigid+Jason";
    let measured = eigen(&format!("{rigid} --bicycle-set w=1.1"));
    let sds = measured["bicycle"]["uncertainties"].as_object().expect("deviations");
    assert!(!sds.contains_key("w") && sds.contains_key("c"), "{sds:?}");
    for (texts, named) in [
        ("--bicycle-set lam", &["--bicycle-set lam", "KEY=VALUE"][..]),
        ("--bicycle-set laM=1", &["`laM`", "w, c, lam"]),
        ("--bicycle-set w=x", &["`x` is not a number"]),
        ("--bicycle-set w=99", &["`w` = 99", "0.1 to 5"]),
        (&format!("{rigid} --bicycle-set mB=90"), &["mB=90", "change their files"]),
    ] {
        bench.run(&format!("eigen {texts}")).rejected_naming(named);
    }
    let sweep = "sweep --law h --over bicycle-set=lam=0.3,lam=0.4 --speeds 4 --scan-step 4 --tolerance 1 --max-rate 8 --time-limit 0.5 --out s";
    assert_eq!(bench.run(sweep).code, Some(0));
    assert!(bench.read("s/sweep.csv").contains("\nlam=0.4,"));
}
