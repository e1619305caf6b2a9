//! `sim-host identify RECORD`: from a record to a rider's file.

use serde_json::{Value, json};
use std::process::Stdio;
use tests::cli::{Bench, Run, repository};
use tests::json_schema::violations;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

/// A quick identification: five gains, no reduction.
const FIVE: &str = "--feedback K_phi_p,K_phi_d,K_delta_i,K_delta_d,K_delta_dd --reduce-until none";

/// Records of 20 s of the young cyclist, on the linear bicycle's side of the nonlinear one.
fn recorded(bench: &Bench, name: &str, options: &str) {
    let line = format!(
        "record --rider young --speed 4.3 --duration 20 --pulse-interval 2 --out {name}.csv --json {name}.json {options}"
    );
    let run = bench.run(&line);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
}

/// Situation: a noisy record of 20 s by a known rider.
/// Action: identify all gains, with the delay's profile, a rider's file, a table and a figure; ride with the file.
/// Must hold: the document is valid and as documented; the gains are within three standard errors; the rider's file is taken by
/// `rider check`, `rider show` and `basin`, with the identified gains; table and figure have their content.
#[test]
fn a_record_becomes_a_rider() {
    let bench = Bench::new(PROGRAM);
    recorded(&bench, "run", "--steer-noise 0.002");
    let options =
        "--delay 30ms --delay-profile 20:40:5 --select bic --out rider.toml --csv o.csv --svg o.svg";
    let document = bench.json(&format!("identify run.csv --bicycle rigid_jason {options}"));
    let schema = std::fs::read_to_string(repository("docs/schema/identify.json")).expect("a schema");
    let committed: Value = serde_json::from_str(&schema).expect("JSON");
    assert_eq!(violations(&committed, &document), [""; 0]);
    for name in ["identify", "identify-many"] {
        let committed =
            std::fs::read_to_string(repository(&format!("docs/schema/{name}.json"))).expect("a schema");
        let own = bench.run(&format!("schema {name}")).stdout;
        assert!(own == committed, "run: sim-host schema {name} > docs/schema/{name}.json");
    }
    let truth: Value = serde_json::from_str(&bench.read("run.json")).expect("JSON");
    let gains = document["gains"].as_object().expect("gains");
    assert!((4..=8).contains(&gains.len()), "{gains:?}");
    for (name, gain) in gains {
        let [value, error] = ["value", "std_error"].map(|key| gain[key].as_f64().expect("a number"));
        let expected = truth["gains"]["gains"][name].as_f64().expect("a gain");
        assert!(
            error > 0.0 && (value - expected).abs() < 3.0 * error,
            "{name}: {value}, {error}, {expected}"
        );
    }
    let vaf = document["vaf"].as_f64().expect("a number");
    assert!((0.95..1.0).contains(&vaf), "{vaf}");
    assert_eq!((&document["delay_s"], &document["rider_file"]), (&json!(0.03), &json!("rider.toml")));
    assert_eq!((&document["refined"], &document["warnings"]), (&json!(true), &json!([])));
    let delay = &document["delay"]["estimate_s"].as_f64().expect("an estimate");
    assert!((0.02..0.04).contains(delay), "{delay}");
    assert!(!document["optima"].as_array().expect("optima").is_empty());
    let steps = document["reduction"].as_array().expect("steps");
    assert!(steps.len() >= 4 && steps[0]["gains"].as_object().expect("gains").len() == 8);
    assert_eq!(
        steps[document["selected"].as_u64().expect("an index") as usize]["gains"]
            .as_object()
            .map(|g| g.len()),
        Some(gains.len())
    );

    assert_eq!(bench.run("rider check rider.toml").code, Some(0));
    let shown = bench.json("rider show rider.toml");
    assert_eq!(shown["rows"][0]["gains"]["K_phi_p"], gains["K_phi_p"]["value"]);
    let basin = bench.json("basin --rider rider.toml --law none --speeds 4.3 --max-rate 6 --tolerance 0.25");
    assert_eq!(basin["border"][0]["outcome"], json!("recovered"));
    assert!(
        basin["area_capped"] == json!(true) || basin["area"].as_f64().is_some_and(|area| area > 0.0),
        "{basin}"
    );
    assert!(bench.read("o.csv").lines().any(|line| line.starts_with("run.csv,0,false,K_delta_dd,")));
    assert!(bench.read("o.svg").contains("of the variance accounted for"));
    let text = bench.run(&format!("identify run.csv {FIVE} --linear"));
    assert!(text.stdout.contains("K_phi_p") && text.stdout.contains("(linear bicycle)"), "{}", text.stdout);
}

/// Situation: a record with a remnant stronger than the response, whose likeliest gains are far from the rider's and make an
/// unstable loop; another optimum is nearly as likely.
/// Action: identify.
/// Must hold: neither document nor rider's file has standard errors or covariances, and both state why; the warnings name the
/// signal to noise, the instability and the other optimum, whose drop of the log-likelihood is that of the VAFs.
#[test]
fn an_unstable_fit_has_no_standard_errors() {
    let bench = Bench::new(PROGRAM);
    let noise = "--remnant 0.5 --steer-noise 0.001 --roll-noise 0.002 --roll-rate-noise 0.01 --seed 1";
    bench.run(&format!("record --rider young --speed 5 {noise} --out run.csv"));
    let document = bench.json("identify run.csv --delay 30ms --reduce-until none --out rider.toml");
    assert!(document["rightmost_eigenvalue_1_s"].as_f64().is_some_and(|real| real > 1e-3), "{document}");
    assert!(document["covariance"].is_null());
    let errors = |gains: &Value| -> Vec<Value> {
        gains.as_object().expect("gains").values().map(|gain| gain["std_error"].clone()).collect()
    };
    assert_eq!(errors(&document["gains"]), vec![Value::Null; 8]);
    assert_eq!(errors(&document["reduction"][0]["gains"]), vec![Value::Null; 8]);
    assert_eq!(document["not_identified"], json!([]));
    let rider = bench.read("rider.toml");
    assert!(!rider.contains("covariances") && rider.contains("the closed loop of these gains is unstable"));
    let warnings = document["warnings"].to_string();
    for word in ["signal to noise of steer is 0.77", "unstable", "another optimum", "K_delta_i is 134.7"] {
        assert!(warnings.contains(word), "{word}: {warnings}");
    }
    let number = |value: &Value| value.as_f64().expect("a number");
    let optima = &document["optima"];
    let rest = [0, 1].map(|i| 1.0 - number(&optima[i]["vaf"]));
    let expected = number(&document["independent_samples"]) / 2.0 * (rest[1] / rest[0]).ln();
    let drop = number(&optima[1]["log_likelihood_drop"]);
    assert!((drop / expected - 1.0).abs() < 0.1 && drop < 1.92, "{drop} {expected}");
    assert_eq!(number(&optima[0]["log_likelihood_drop"]), 0.0);
    let draws = bench.run("basin --rider rider.toml --rider-draws 5 --speeds 5");
    assert!(draws.code == Some(1) && draws.stderr.contains("covariances"), "{}", draws.stderr);
}

/// Situation: two records, a file that is none, and a folder for the results.
/// Action: identify them together, twice.
/// Must hold: the good ones are finished and merged into one rider, the other is named; the second time nothing is fitted again and
/// the result is the same; with other options it is fitted again.
#[test]
fn finished_records_are_kept() {
    let bench = Bench::new(PROGRAM);
    recorded(&bench, "a", "");
    recorded(&bench, "b", "--seed 1");
    bench.write("c.csv", "time_s,steer_rad\n0,0\n0.01,0\n");
    let line = format!("identify a.csv b.csv c.csv {FIVE} --linear --results found --out both.toml --json");
    let first = bench.run(&line);
    assert_eq!(first.code, Some(0), "{}", first.stderr);
    assert!(first.stderr.contains("c.csv: not used: "), "{}", first.stderr);
    assert!(!first.stderr.contains("c.csv: not used: c.csv"), "{}", first.stderr);
    let second = bench.run(&line);
    assert!(second.stderr.contains("a.csv: finished before; not fitted again"), "{}", second.stderr);
    assert_eq!(first.stdout, second.stdout);
    // The text of a finished record is the same, too, with its gains.
    let shown = bench.run(&format!("identify a.csv {FIVE} --linear --results found"));
    assert!(shown.stderr.contains("finished before"), "{}", shown.stderr);
    assert!(
        shown.stdout.starts_with("a.csv: 20.0 s") && shown.stdout.contains("K_delta_dd"),
        "{}",
        shown.stdout
    );
    let document: Value = serde_json::from_str(&first.stdout).expect("JSON");
    assert_eq!(document["records"].as_array().map(Vec::len), Some(2));
    assert!(
        document["refused"]["c.csv"]
            .as_str()
            .is_some_and(|why| why.contains("usable samples: 2 of at least 100"))
    );
    assert_eq!(bench.json("rider show both.toml")["rows"].as_array().map(Vec::len), Some(2));
    bench.write("a.txt", "");
    let same = bench.run(&format!("identify a.csv a.txt {FIVE} --results found"));
    assert!(same.stderr.contains("a.csv and a.txt would have results of the same name"), "{}", same.stderr);
    let twice = bench.run(&format!("identify a.csv ./a.csv {FIVE}"));
    assert!(twice.code == Some(1) && twice.stderr.contains("./a.csv is given twice"), "{}", twice.stderr);
    let other = bench.run(&format!("{line} --drift none"));
    assert!(!other.stderr.contains("finished before"), "{}", other.stderr);
}

/// Situation: three records.
/// Action: two processes with the same folder identify them at the same time.
/// Must hold: each record is fitted by one of them and taken over by the other; both end with the same document, which is that of one
/// process; no claim remains.
#[test]
fn processes_share_the_records() {
    let bench = Bench::new(PROGRAM);
    ["a", "b", "c"].iter().enumerate().for_each(|(i, name)| recorded(&bench, name, &format!("--seed {i}")));
    let line = format!("identify a.csv b.csv c.csv {FIVE} --linear --json");
    let spawn = || {
        let mut command = bench.command(&format!("{line} --results shared"));
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts")
    };
    let runs = [spawn(), spawn()].map(|child| Run::from(child.wait_with_output().expect("the program ends")));
    let taken_over: usize = runs.iter().map(|run| run.stderr.matches("finished before").count()).sum();
    assert_eq!((runs[0].code, runs[1].code, taken_over), (Some(0), Some(0), 3), "{runs:?}");
    assert_eq!(runs[0].stdout, runs[1].stdout);
    assert_eq!(runs[0].stdout, bench.run(&format!("{line} --results alone")).stdout);
    assert!(!bench.path("shared/claims").exists());
}

/// A record as text, changed line by line.
fn changed(bench: &Bench, name: &str, change: impl Fn(usize, Vec<String>) -> Option<String>) {
    let text = bench.read("run.csv");
    let lines = text.lines().enumerate();
    let lines: Vec<String> =
        lines.filter_map(|(i, line)| change(i, line.split(',').map(str::to_owned).collect())).collect();
    bench.write(name, lines.join("\n") + "\n");
}

/// Situation: records with faults that a lab's export has.
/// Must hold: each is told in words, with what was done; what can be used is used; nothing is written for the others.
#[test]
fn faults_of_a_record_are_told() {
    let bench = Bench::new(PROGRAM);
    recorded(&bench, "run", "--steer-noise 0.001");
    let fit = |name: &str, options: &str| {
        bench.run(&format!("identify {name} {FIVE} --linear --out rider-{name}.toml {options}"))
    };
    let refused = |name: &str, options: &str, words: &[&str]| {
        let run = fit(name, options);
        assert_eq!(run.code, Some(1), "{name}: {}", run.stderr);
        for word in words {
            assert!(run.stderr.contains(word), "{name}: `{word}` in {}", run.stderr);
        }
        assert!(!bench.path(&format!("rider-{name}.toml")).exists(), "{name}");
    };
    let used = |name: &str, options: &str, words: &[&str]| {
        let run = fit(name, options);
        assert_eq!(run.code, Some(0), "{name}: {}", run.stderr);
        for word in words {
            assert!(run.stderr.contains(word), "{name}: `{word}` in {}", run.stderr);
        }
        assert!(bench.read(&format!("rider-{name}.toml")).contains("covariances"), "{name}");
    };
    let degrees = |cell: &str| cell.parse::<f64>().map_or(cell.to_owned(), |x| (57.3 * x).to_string());
    // Degrees in a column of radians.
    changed(&bench, "degrees.csv", |_, mut cells| {
        cells[2] = degrees(&cells[2]);
        Some(cells.join(","))
    });
    let run = fit("degrees.csv", "");
    assert!(
        run.stderr.contains("steer reaches") && run.stderr.contains("is it in degrees?"),
        "{}",
        run.stderr
    );
    // The same with the right name.
    changed(&bench, "named.csv", |i, mut cells| {
        cells[2] = if i == 0 { "steer_deg".to_owned() } else { degrees(&cells[2]) };
        Some(cells.join(","))
    });
    used("named.csv", "", &[]);
    // Rows that are missing, blank or back in time.
    changed(&bench, "gaps.csv", |i, cells| (!(900..1000).contains(&i)).then(|| cells.join(",")));
    used("gaps.csv", "", &["steer angle: ", "samples missing; not fitted"]);
    changed(&bench, "blank.csv", |i, mut cells| {
        if (1200..1210).contains(&i) {
            cells[2].clear();
        }
        Some(cells.join(","))
    });
    used("blank.csv", "", &["samples missing"]);
    changed(&bench, "back.csv", |i, mut cells| {
        if (700..720).contains(&i) {
            cells[0] = "1.0".into();
        }
        Some(cells.join(","))
    });
    used("back.csv", "", &["the time goes back from 3.49 to 1 s; 20 of 4000 samples left out"]);
    // Error values of a logger.
    let outlier = |name: &str, column: usize, value: &'static str| {
        changed(&bench, name, move |i, mut cells| {
            if i == 1500 {
                cells[column] = value.into();
            }
            Some(cells.join(","))
        });
    };
    outlier("huge.csv", 2, "1e300");
    used(
        "huge.csv",
        "",
        &["steer angle: outliers, 1 of 4000 samples, 1 of them left out; the first is 1e300 rad at 7.495 s"],
    );
    outlier("large.csv", 2, "9");
    used(
        "large.csv",
        "",
        &["steer angle: outliers, 1 of 4000 samples, 0 of them left out; the first is 9 rad at 7.495 s"],
    );
    outlier("fast.csv", 5, "1e300");
    used("fast.csv", "", &["speed: outliers, 1 of 4000"]);
    outlier("ahead.csv", 0, "1e300");
    used("ahead.csv", "", &["the time goes back from 1e300 to 7.5 s; 1 of 4000 samples left out"]);
    outlier("hit.csv", 1, "1e300");
    assert!(
        fit("hit.csv", "").stderr.contains("the largest lateral force is 1e300 N; 2 to 1000 N are expected")
    );
    // Columns of text beside the record's are no concern of it; text in its own columns is.
    changed(&bench, "notes.csv", |i, mut cells| {
        cells.push(if i == 0 { "note".into() } else { "windy".into() });
        Some(cells.join(","))
    });
    let run = fit("notes.csv", "");
    assert!(run.code == Some(0) && run.stderr.is_empty(), "{}", run.stderr);
    changed(&bench, "words.csv", |i, mut cells| {
        if (800..810).contains(&i) {
            cells[2] = "lost".into();
        }
        Some(cells.join(","))
    });
    used(
        "words.csv",
        "",
        &["line 801: steer_rad: `lost` is no number", "steer_rad: 7 more cells that are no number"],
    );
    // Units of the time.
    let times = |name: &str, column: &'static str, factor: f64| {
        changed(&bench, name, move |_, mut cells| {
            cells[0] = cells[0].parse::<f64>().map_or(column.into(), |t| (factor * t).to_string());
            Some(cells.join(","))
        });
    };
    for (name, column, factor, unit) in [
        ("ms.csv", "time_s", 1e3, "milliseconds"),
        ("us.csv", "time_s", 1e6, "microseconds"),
        ("ns.csv", "time_s", 1e9, "nanoseconds"),
        ("s.csv", "time_ms", 1.0, "seconds"),
    ] {
        times(name, column, factor);
        refused(name, "", &["sample rate", &format!("is the time in {unit}?")]);
    }
    // Nothing to identify.
    changed(&bench, "still.csv", |i, mut cells| {
        if i > 0 {
            cells[1] = "0.0".into();
        }
        Some(cells.join(","))
    });
    refused("still.csv", "", &["still.csv", "no perturbation"]);
    changed(&bench, "short.csv", |i, cells| (i < 900).then(|| cells.join(",")));
    refused("short.csv", "", &["short.csv", "4.49 s long", "at least 5 s"]);
    changed(&bench, "unnamed.csv", |i, mut cells| {
        if i == 0 {
            cells[1] = "push".into();
        }
        Some(cells.join(","))
    });
    refused("unnamed.csv", "", &["no perturbation", "lateral_force_n"]);
    changed(&bench, "slow.csv", |i, cells| (i % 20 == 0).then(|| cells.join(",")));
    refused("slow.csv", "", &["sample rate is 10", "20 to 2000 Hz"]);
    changed(&bench, "nospeed.csv", |_, cells| Some(cells[..5].join(",")));
    refused("nospeed.csv", "", &["--speed"]);
    used("nospeed.csv", "--speed 4.3", &[]);
    let none = fit("none.csv", "");
    assert!(
        none.code == Some(1) && none.stderr.starts_with("error: none.csv: can't be read: "),
        "{}",
        none.stderr
    );
    for option in ["--feedback K_phi_p,K_phi_d,K_phi_p", "--fit steer,roll,steer"] {
        let run = bench.run(&format!("identify run.csv {option}"));
        assert!(run.code == Some(1) && run.stderr.contains("is given twice"), "{option}: {}", run.stderr);
    }
    // An input is never an output.
    for option in ["--out", "--report", "--json", "--csv", "--svg"] {
        let before = bench.read("run.csv");
        let run = bench.run(&format!("identify run.csv {FIVE} --linear {option} run.csv"));
        assert!(run.code == Some(1) && run.stderr.contains("run.csv"), "{option}: {}", run.stderr);
        assert!(bench.read("run.csv") == before, "{option}");
    }
    // A force of the wrong sign.
    changed(&bench, "flipped.csv", |i, mut cells| {
        if i > 0 {
            cells[1] = (-cells[1].parse::<f64>().expect("a number")).to_string();
        }
        Some(cells.join(","))
    });
    let run = fit("flipped.csv", "");
    assert!(
        run.stderr.contains("check the sign") || run.stderr.contains("the sign or unit"),
        "{}",
        run.stderr
    );
    let usage = [
        ("--delay 30", "30"),
        ("--delay 1.01s", "0 s to 1 s"),
        ("--fit yaw", "yaw"),
        ("--feedback K_psi", "K_phi_p"),
        ("--drift 3", "0.05Hz"),
        ("--select best", "vaf:PERCENT"),
        ("--delay-profile 0:10", "FROM:TO:STEP"),
        ("--force-at 1", "AHEAD,HEIGHT"),
        ("--force-at nan,1", "AHEAD (m)"),
    ];
    for (option, word) in usage {
        let run = bench.run(&format!("identify run.csv {option}"));
        assert!(run.code == Some(2) && run.stderr.contains(word), "{option}: {}", run.stderr);
    }
    assert_eq!(bench.run("identify").code, Some(2));
}

/// Situation: a record with other names and units, read with a map.
/// Must hold: the same gains as from the documented columns.
#[test]
fn a_map_names_the_columns() {
    let bench = Bench::new(PROGRAM);
    recorded(&bench, "run", "");
    changed(&bench, "lab.csv", |i, cells| {
        if i == 0 {
            return Some("sample,pull,handlebar,belt".into());
        }
        let [force, steer, speed] = [1, 2, 5].map(|place| cells[place].parse::<f64>().expect("a number"));
        Some(format!("{i},{},{},{}", -force / 1e3, -steer.to_degrees(), 3.6 * speed))
    });
    bench.write(
        "lab.toml",
        "[time]\nrate_hz = 200\n[perturbation.lateral_force]\ncolumns = [\"pull\"]\nunit = \"kN\"\nscale = -1\n\
         [steer]\ncolumns = [\"handlebar\"]\nunit = \"deg\"\nscale = -1\n[rear_wheel]\ncolumns = [\"belt\"]\nunit = \"km/h\"\n",
    );
    let [plain, mapped] = ["run.csv", "lab.csv --map lab.toml"]
        .map(|file| bench.json(&format!("identify {file} {FIVE} --linear"))["gains"].clone());
    for (name, gain) in plain.as_object().expect("gains") {
        let [a, b] = [gain, &mapped[name]].map(|gain| gain["value"].as_f64().expect("a number"));
        assert!((a - b).abs() < 1e-6 * a.abs(), "{name}: {a} {b}");
    }
}
