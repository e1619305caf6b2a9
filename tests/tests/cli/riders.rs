//! Riders on the command line: names, files, options, and their errors.

use serde_json::{Value, json};
use sim_host::rider::{KEYS, catalogue};
use tests::cli::{Bench, repository, word};
use tests::detection::rows_of;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

/// A good table, one line per key.
const TABLE: &str = "\
schema = 1
delay_ms = 30
columns = ['speed_m_s', 'run', 'group', 'vaf', 'K_phi_p', 'K_delta_d']
rows = [
  [2.0, 1, 1, 90, 10, -1], [2.2, 2, 1, 95, 20, -2],
  [4.0, 3, 2, 92, 30, -3], [4.0, 4, 2, 91, 40, -5],
]
";

/// Situation: a table with one error each.
/// Action: check it, and ride it.
/// Must hold: rejected in one paragraph that names the file, the key or row, the value and the allowed ones.
#[test]
fn wrong_tables_are_rejected_with_the_reason() {
    let bench = Bench::new(PROGRAM);
    bench.write("my.toml", TABLE);
    assert_eq!(bench.run("rider check my.toml").code, Some(0));
    for (right, wrong, named) in [
        ("schema = 1\n", "", &["missing", "schema"][..]),
        ("schema = 1", "schema = 2", &["`schema` = 2", "reads 1"]),
        ("delay_ms = 30\n", "", &["missing", "delay_ms"]),
        ("delay_ms = 30", "delay_ms = -30", &["`delay_ms` = -30", "0 to 1000"]),
        ("delay_ms = 30", "delay_ms = nan", &["`delay_ms` = NaN", "0 to 1000"]),
        ("delay_ms = 30", "delay_ms = 3000", &["`delay_ms` = 3000", "0 to 1000"]),
        ("delay_ms = 30", "delay_ms = 'x'", &["line 2", "\"x\""]),
        ("delay_ms = 30", "delay_ms = 30\ndelay_s = 1", &["line 3", "delay_s"]),
        ("delay_ms = 30", "delay_ms = 30\nfeedback = 'all'", &["line 3", "all", "nested"]),
        (
            "delay_ms = 30",
            "delay_ms = 30\nneuromuscular = { omega_rad_s = 0, zeta = 1 }",
            &["`neuromuscular`", "= 0 ", "0.1 to 200"],
        ),
        ("delay_ms = 30", "delay_ms = 30\nneuromuscular = { omega_rad_s = 9 }", &["line 3", "zeta"]),
        ("delay_ms = 30", "delay_ms = 30\nbest_runs = [1, 9]", &["`best_runs`", "run 9"]),
        (
            "delay_ms = 30",
            "delay_ms = 30\nregression = { K_y = [1, 2] }",
            &["`regression`", "`K_y`", "column"],
        ),
        ("delay_ms = 30", "delay_ms = 30\nregression = {}", &["`regression`", "is missing"]),
        ("delay_ms = 30", "delay_ms = 30\nbest_runs = [1]", &["`best_runs`", "0 rows", "4 m/s"]),
        ("delay_ms = 30", "delay_ms = 30\nbest_runs = [1, 2, 3]", &["`best_runs`", "2 rows", "2 m/s"]),
        ("'K_phi_p'", "'K_phi'", &["`columns`", "unknown column `K_phi`", "K_phi_p, K_phi_i"]),
        ("'K_phi_p'", "'k_delta'", &["unknown column `k_delta`"]),
        ("'K_phi_p'", "'K_delta_d'", &["`columns`", "`K_delta_d` is listed twice"]),
        ("'speed_m_s'", "'K_y'", &["`columns`", "`speed_m_s` is missing"]),
        ("[2.2, 2, 1, 95, 20, -2]", "[2.2, 2, 1, 95, 20]", &["row 2", "5 values", "6 columns"]),
        ("[2.2, 2, 1, 95, 20, -2]", "[2.2, 2, 1, 95, 20, -2, 0]", &["row 2", "7 values"]),
        ("[2.2, 2, 1, 95, 20, -2]", "[1.9, 2, 1, 95, 20, -2]", &["row 2", "1.9", "after 2", "sorted"]),
        ("[2.2, 2, 1, 95, 20, -2]", "[2.2, 2, 1, 95, inf, -2]", &["row 2", "`K_phi_p` = inf", "100000"]),
        ("[2.2, 2, 1, 95, 20, -2]", "[2.2, 2, 1, 95, nan, -2]", &["row 2", "`K_phi_p` = NaN"]),
        ("[2.2, 2, 1, 95, 20, -2]", "[nan, 2, 1, 95, 20, -2]", &["row 2", "`speed_m_s` = NaN", "0 to 30"]),
        ("[2.2, 2, 1, 95, 20, -2]", "[31, 2, 1, 95, 20, -2]", &["row 2", "`speed_m_s` = 31", "0 to 30"]),
        ("[2.2, 2, 1, 95, 20, -2]", "[2.2, 2.5, 1, 95, 20, -2]", &["row 2", "`run` = 2.5", "whole"]),
        ("[2.2, 2, 1, 95, 20, -2]", "[2.2, 2, 0, 95, 20, -2]", &["row 2", "`group` = 0", "1 to"]),
        ("[4.0, 4, 2, 91, 40, -5]", "[4.0, 4, 1, 91, 40, -5]", &["row 4", "`group` = 1", "after 2"]),
        ("[2.2, 2, 1, 95, 20, -2]", "[2.2, 2, 1, 195, 20, -2]", &["row 2", "`vaf` = 195", "to 100"]),
        ("[4.0, 4, 2, 91, 40, -5]", "[4.0, 4, 3, 91, 40, -5]", &["means of groups", "4", "rise"]),
        ("[2.2, 2, 1, 95, 20, -2]", "['a', 2, 1, 95, 20, -2]", &["line 5", "\"a\""]),
        ("delay_ms = 30", "delay_ms = 30\ncovariances = [[]]", &["`covariances`", "1 matrices", "4 `rows`"]),
        (
            "delay_ms = 30",
            "delay_ms = 30\ncovariances = [[], [[1, 0]], [], []]",
            &["row 2", "`covariances`", "1 x 2", "2 x 2"],
        ),
        (
            "delay_ms = 30",
            "delay_ms = 30\ncovariances = [[], [], [[1, 0], [0, -1]], []]",
            &["row 3", "`covariances`", "variance of K_delta_d = -1", "0 to 10000000000"],
        ),
        (
            "delay_ms = 30",
            "delay_ms = 30\ncovariances = [[], [], [], [[1, 3], [3, 4]]]",
            &["row 4", "`covariances`", "K_phi_p and K_delta_d = 3", "-2"],
        ),
        (
            "delay_ms = 30",
            "delay_ms = 30\ncovariances = [[[1, 0.5], [0, 1]], [], [], []]",
            &["row 1", "`covariances`", "0.5", "symmetric"],
        ),
    ] {
        assert!(TABLE.contains(right), "{right}");
        bench.write("my.toml", TABLE.replacen(right, wrong, 1));
        let named: Vec<&str> = named.iter().copied().chain(["my.toml"]).collect();
        bench.run("rider check my.toml").rejected_naming(&named);
        bench.run("ride --speed 4 --rider my.toml").rejected_naming(&named);
    }
    let without = |rows: &str, columns: &str| {
        format!("schema = 1\ndelay_ms = 0\ncolumns = [{columns}]\nrows = {rows}\n")
    };
    bench.write("my.toml", without("[[2.0, 90]]", "'speed_m_s', 'vaf'"));
    bench.run("rider check my.toml").rejected_naming(&["my.toml", "no gains", "K_phi_p"]);
    bench.write("my.toml", without("[]", "'speed_m_s', 'K_y'"));
    bench.run("rider check my.toml").rejected_naming(&["my.toml", "`rows` = 0", "1 to 1000"]);
    bench.write("my.toml", b"\xff\xfe");
    bench.run("rider check my.toml").rejected_naming(&["my.toml", "UTF-8"]);
    bench.run("rider check missing.toml").rejected_naming(&["missing.toml", "no such file", "young", "hess"]);
    std::fs::create_dir(bench.path("folder")).unwrap();
    bench.run("rider check folder").rejected_naming(&["folder"]);
}

/// Situation: invalid options of a rider.
/// Action: give them.
/// Must hold: rejected, naming the option, the value and the allowed ones; without a rider the options do not exist.
#[test]
fn wrong_options_of_a_rider_are_rejected() {
    let bench = Bench::new(PROGRAM);
    for (line, named) in [
        ("ride --speed 4 --rider old", &["unknown rider `old`", "young, smart, smart6"][..]),
        ("basin --speeds 4 --rider old", &["unknown rider `old`"]),
        (
            "ride --speed 4 --rider young --law h --delay 24.5ms",
            &["--delay", "24.5 ms", "1 ms", "24 ms and 25 ms"],
        ),
        ("ride --speed 4 --rider young --preset product --delay 0.4ms", &["--delay", "0 ms and 1 ms"]),
        ("ride --speed 4 --rider young --delay 0.004ms", &["--delay", "0.004 ms", "0.01 ms"]),
    ] {
        bench.run(line).rejected_naming(named);
    }
    for (options, word) in [
        ("--rider young --delay -60ms", "0 s to 1 s"),
        ("--rider young --delay 1.001s", "0 s to 1 s"),
        ("--rider young --delay nanms", "0 s to 1 s"),
        ("--rider young --delay 60", "20ms or 0.02s"),
        ("--rider young --gains median", "regression, mean, best, spline"),
        ("--rider young --gains-outside zero", "extrapolate, hold"),
        ("--gains mean", "--rider"),
        ("--delay 60ms", "--rider"),
        ("--gains-outside hold", "--rider"),
    ] {
        for command in ["ride --speed 4", "basin --speeds 4"] {
            let run = bench.run(&format!("{command} {options}"));
            assert!(run.code == Some(2) && run.stderr.contains(word), "{options}: {}", run.stderr);
        }
    }
    bench.write("my.toml", TABLE.replace("'vaf'", "'K_y'"));
    let run = bench.run("ride --speed 4 --rider my.toml --gains best");
    run.rejected_naming(&["my.toml", "best", "2 sets", "2 m/s", "`vaf`", "best_runs"]);
    assert_eq!(bench.run("ride --speed 4 --rider my.toml --gains mean").code, Some(0));
}

/// Situation: no options but a rider; then each of them.
/// Action: read the configuration of a ride's document.
/// Must hold: the documented defaults, the options, the points.
#[test]
fn options_of_a_rider_are_in_the_configuration() {
    let bench = Bench::new(PROGRAM);
    let config = |options: &str| bench.json(&format!("ride --speed 4 {options}"))["config"].clone();
    assert_eq!(config("")["rider"], Value::Null);
    let young = config("--rider young");
    let rider = &young["rider"];
    assert_eq!(
        (&young["law"]["name"], &young["assist"], &young["step_s"]),
        (&json!("none"), &json!("none"), &json!(1e-3))
    );
    assert_eq!(
        (&rider["name"], &rider["gains"], &rider["delay_s"]),
        (&json!("young"), &json!("mean"), &json!(0.03))
    );
    assert_eq!((&rider["outside"], rider["points"].as_array().unwrap().len()), (&json!("extrapolate"), 5));
    assert!(rider["source"].as_str().unwrap().contains("F.2"));
    let first = &rider["points"][0];
    assert!((first["speed_m_s"].as_f64().unwrap() - 6.5 / 3.0).abs() < 1e-12);
    assert!((first["gains"]["K_phi_p"].as_f64().unwrap() - (44.08 + 71.05 + 43.21) / 3.0).abs() < 1e-12);
    assert_eq!((&first["gains"]["K_phi_i"], first["gains"].as_object().unwrap().len()), (&json!(0.0), 10));
    assert!((rider["muscles"]["omega_rad_s"].as_f64().unwrap() - 13.6345).abs() < 1e-4);

    let naive = config("--rider young --delay 60ms --gains best --gains-outside hold")["rider"].clone();
    assert_eq!(
        (&naive["delay_s"], &naive["gains"], &naive["outside"]),
        (&json!(0.06), &json!("best"), &json!("hold"))
    );
    assert_eq!(naive["points"][1]["gains"]["K_phi_p"], json!(34.51));
    let line = config("--rider young --gains regression")["rider"]["points"].clone();
    assert_eq!((line.as_array().unwrap().len(), &line[1]["speed_m_s"]), (2, &json!(7.4)));

    // A rider has no assist by default.
    for (options, law, assist) in [
        ("--rider young --law h", "h", "firmware"),
        ("--rider young --preset product", "h-cut", "firmware"),
        ("--rider smart --preset product --law none", "none", "none"),
        ("--rider hess --law h --assist ideal", "h", "ideal"),
    ] {
        let config = config(options);
        assert_eq!((&config["law"]["name"], &config["assist"]), (&json!(law), &json!(assist)), "{options}");
    }
}

/// Situation: delays that are no whole milliseconds, without the firmware.
/// Action: ride.
/// Must hold: the largest step up to 1 ms of which the delay is a whole number, reported on standard error; whole
/// milliseconds leave the step unchanged and report nothing.
#[test]
fn the_step_divides_the_delay() {
    let bench = Bench::new(PROGRAM);
    for (options, step, note) in [
        ("--delay 24.5ms", 0.98e-3, "note: step 0.98 ms so that the delay of 24.5 ms is 25 steps\n"),
        (
            "--delay 0.4ms --law h --assist ideal",
            0.4e-3,
            "note: step 0.4 ms so that the delay of 0.4 ms is 1 steps\n",
        ),
        ("--delay 30ms", 1e-3, ""),
        ("--delay 0.06s", 1e-3, ""),
        ("--delay 1s", 1e-3, ""),
        ("--delay 0ms", 1e-3, ""),
    ] {
        let run = bench.run(&format!("ride --speed 4 --rider young {options} --json"));
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), note), "{options}");
        let document: Value = serde_json::from_str(&run.stdout).unwrap();
        assert!((document["config"]["step_s"].as_f64().unwrap() - step).abs() < 1e-15, "{options}");
    }
}

/// Situation: basins with and without a rider, no speeds given.
/// Action: read the speeds of the documents.
/// Must hold: where the gains were measured with one, 0 to 10 m/s without.
#[test]
fn a_riders_basin_is_over_the_measured_speeds() {
    let bench = Bench::new(PROGRAM);
    let quick = "--scan-step 30 --tolerance 15 --time-limit 0.002";
    let speeds = |options: &str| bench.json(&format!("basin {quick} {options}"))["speeds"].clone();
    let ends = |v: &Value| {
        let v = v.as_array().unwrap();
        (v.len(), v[0].as_f64().unwrap(), v[v.len() - 1].as_f64().unwrap())
    };
    assert_eq!(ends(&speeds("--rider young")), (56, 2.0, 7.5));
    assert_eq!(ends(&speeds("--rider young --speeds 3:4:0.5")), (3, 3.0, 4.0));
    assert_eq!(ends(&speeds("")), (101, 0.0, 10.0));
}

/// Situation: the shipped riders.
/// Action: list, show, check.
/// Must hold: every name is in the list; the output of `show` is a file with the same gains; JSON and CSV have all
/// rows and fits; `--gains` leaves the others out.
#[test]
fn list_show_and_check() {
    let bench = Bench::new(PROGRAM);
    let list = bench.run("rider list");
    for name in ["young", "smart", "smart6", "undelayed", "undelayed-alt", "hess", "hess-benchmark"] {
        assert!(list.stdout.lines().any(|l| l.split(' ').next() == Some(name)), "{name}");
        let shown = bench.run(&format!("rider show {name}"));
        bench.write("shown.toml", &shown.stdout);
        let gains = |rider: &str| bench.json(&format!("rider show {rider}"));
        let (of_name, of_file) = (gains(name), gains("shown.toml"));
        for key in ["rows", "fits", "delay_s", "muscles", "source", "note"] {
            assert_eq!(of_name[key], of_file[key], "{name} {key}");
        }
        let check = bench.run(&format!("rider check {name}"));
        assert!(check.code == Some(0) && check.stdout.starts_with(&format!("{name}: sound\n")), "{check:?}");
    }
    let young = bench.json("rider show young");
    let fits = young["fits"].as_array().unwrap();
    assert_eq!((young["rows"].as_array().unwrap().len(), fits.len()), (15, 4));
    assert_eq!(young["rows"][3]["gains"]["K_delta_i"], json!(121.1));
    assert!((fits[0]["r_squared"]["K_delta_i"].as_f64().unwrap() - 0.855).abs() < 0.001);
    assert_eq!((&fits[0]["r_squared"]["K_psi"], &fits[1]["line"]), (&Value::Null, &Value::Null));
    // The spline: a curve where the line explains little of a gain that changes with speed.
    let (line, spline) = (&fits[0], &fits[3]);
    for key in ["K_phi_d", "K_delta_i", "K_delta_d", "K_delta_dd"] {
        let r = |fit: &Value| fit["r_squared"][key].as_f64().unwrap();
        assert!(r(spline) > r(line) + 0.05 && r(spline) < 1.0, "{key}: {} {}", r(line), r(spline));
        let freedom = spline["spline"]["degrees_of_freedom"][key].as_f64().unwrap();
        assert!((4.0..5.0).contains(&freedom), "{key}: {freedom}");
    }
    assert_eq!((&line["spline"], &fits[2]["spline"]), (&Value::Null, &Value::Null));
    let errors = spline["spline"]["standard_errors"].as_array().unwrap();
    assert_eq!(errors.len(), 129);
    assert!(errors.iter().all(|at| at["K_delta_i"].as_f64().is_some_and(|e| (5.0..150.0).contains(&e))));
    let text = bench.run("rider show young --gains spline").stdout;
    assert_eq!(text.lines().filter(|l| l.starts_with("#       +/-")).count(), 5, "{text}");
    let one = bench.json("rider show young --gains best");
    assert_eq!((one["fits"].as_array().unwrap().len(), &one["fits"][0]["gains"]), (1, &json!("best")));

    let csv = bench.run("rider show young --csv -").stdout;
    let lines: Vec<&str> = csv.lines().filter(|l| !l.starts_with('#')).collect();
    assert!(lines[0].starts_with("kind,speed_m_s,run,group,vaf,K_phi_p,"), "{}", lines[0]);
    assert_eq!(lines.len(), 1 + 15 + 2 + 5 + 5 + 129);
    assert!(lines[1].starts_with("measured,2.1,248,1,93.82,44.08,0.0,51.7,"), "{}", lines[1]);
    bench.run("rider show young --csv a --json ./a").rejected_naming(&["--csv", "--json", "same place"]);

    bench.write("my.toml", TABLE.replace("'vaf'", "'K_y'"));
    let check = bench.run("rider check my.toml").stdout;
    assert!(check.contains("gains best: not possible") && check.contains("gains mean: 2 points"), "{check}");
    bench.run("rider show my.toml --gains best").rejected_naming(&["my.toml", "best", "`vaf`"]);
    assert_eq!(bench.json("rider show my.toml")["fits"].as_array().unwrap().len(), 3);
}

/// Situation: the built-in riders. Action: check each. Must hold: the page has the number of speeds at which each of their fits is
/// unstable, some none and some all.
#[test]
fn the_page_has_the_unstable_fits() {
    let bench = Bench::new(PROGRAM);
    let page = std::fs::read_to_string(repository("docs/riders.md")).expect("the page");
    let row = |name| {
        let check = bench.run(&format!("rider check {name}")).stdout;
        let speeds = check.split_once("at the ").and_then(|(_, rest)| rest.split_once(" speeds"));
        let (speeds, _) = speeds.unwrap_or_else(|| panic!("{name}: {check}"));
        let unstable = |line: &str| match line.split_once("unstable at ") {
            Some((_, rest)) => rest.split(' ').next().unwrap_or_default().to_owned(),
            None if line.ends_with(", stable") => "0".into(),
            None => panic!("{name}: {line}"),
        };
        let fits: Vec<String> =
            check.lines().filter(|line| line.starts_with("gains ")).map(unstable).collect();
        format!("| `{name}` | {speeds} | {} |", fits.join(" | "))
    };
    let found: Vec<String> = catalogue::shipped_names().map(row).collect();
    assert_eq!(rows_of(&page, "unstable-fits"), found);
}

/// Situation: a table in which one set has a covariance, and a copy at other speeds.
/// Action: show it, merge both.
/// Must hold: standard errors beside that set's gains, as text with two significant digits at least, JSON and CSV; the text is a file with the covariance;
/// the merged table has all rows, and its groups are by speed.
#[test]
fn standard_errors_are_shown_and_tables_merged() {
    let bench = Bench::new(PROGRAM);
    let covariances = "covariances = [[], [[4, -1], [-1, 0.25]], [], []]\n";
    bench.write("my.toml", format!("{TABLE}{covariances}"));
    let shown = bench.run("rider show my.toml").stdout;
    assert!(
        shown.contains("# 2.2 m/s, run 2:  K_phi_p 20.0000 +/- 2.00  K_delta_d -2.0000 +/- 0.50"),
        "{shown}"
    );
    assert!(shown.contains("# 2 m/s, run 1:  K_phi_p 10.0000  K_delta_d -1.0000"), "{shown}");
    bench.write("small.toml", format!("{TABLE}covariances = [[], [[4e-8, 0], [0, 0.00002]], [], []]\n"));
    let small = bench.run("rider show small.toml").stdout;
    let digits = "# 2.2 m/s, run 2:  K_phi_p 20.00000 +/- 0.00020  K_delta_d -2.0000 +/- 0.0045";
    assert!(small.contains(digits), "{small}");
    bench.write("shown.toml", shown);
    let of = |file: &str| bench.json(&format!("rider show {file}"))["rows"].clone();
    assert_eq!(of("my.toml"), of("shown.toml"));
    assert_eq!(of("my.toml")[1]["standard_errors"], json!({"K_phi_p": 2.0, "K_delta_d": 0.5}));
    assert_eq!(of("my.toml")[0]["standard_errors"], Value::Null);
    let csv = bench.run("rider show my.toml --csv -").stdout;
    assert!(csv.contains("\nmeasured error,2.2,2,1,95.0,2.0,0.0,0.0,0.0,0.0,0.0,0.5,"), "{csv}");

    bench.write("fast.toml", TABLE.replace("[2.0, 1", "[2.4, 5").replace("[2.2, 2", "[2.6, 6"));
    let merge = bench.run("rider merge my.toml fast.toml --out both.toml");
    assert_eq!((merge.code, merge.stdout.as_str()), (Some(0), ""), "{merge:?}");
    let both = of("both.toml");
    let rows: Vec<_> = both.as_array().unwrap().iter().map(|r| (&r["speed_m_s"], &r["group"])).collect();
    let speeds = [2.0, 2.2, 2.4, 2.6, 4.0, 4.0, 4.0, 4.0].map(|v| json!(v));
    let groups = [1, 1, 2, 2, 3, 3, 3, 3].map(|g| json!(g));
    assert_eq!(rows, speeds.iter().zip(&groups).collect::<Vec<_>>());
    assert_eq!(both[1]["standard_errors"], json!({"K_phi_p": 2.0, "K_delta_d": 0.5}));
    bench.run("rider merge my.toml young").rejected_naming(&["my.toml", "young", "gains", "K_delta_i"]);
    bench.run("rider merge my.toml --group-within 0").rejected_naming(&["tolerance", "0", "0.001"]);
}

/// Situation: the commented example, and the same without its gains of the steer acceleration.
/// Action: check both; ride the example; search the basin of both, with and without a law.
/// Must hold: the example is linearly stable at the speeds of its rows with the default fit, and has a
/// basin; the other is unstable at most of these speeds and has no basin, and both commands say so, the basin in a note.
#[test]
fn the_example_is_a_rider() {
    let bench = Bench::new(PROGRAM);
    let example = word(&repository("data/riders/example.toml"));
    let check = bench.run(&format!("rider check {example}")).stdout;
    assert!(check.contains("10 sets in 5 groups, 2.1 to 7.3 m/s, delay 30 ms"), "{check}");
    assert!(check.contains("on bicycle rigid_jason, without a law, at the 8 speeds of the rows"), "{check}");
    assert!(check.contains("gains mean: 5 points, stable\n"), "{check}");
    assert!(check.contains("gains regression: 2 points, unstable at 2 of 8 speeds\n"), "{check}");
    assert_eq!(bench.run(&format!("ride -q --speed 4 --rider {example}")).code, Some(0));

    let mut four =
        catalogue::load(repository("data/riders/example.toml").to_str().unwrap()).expect("the example");
    let steer_acceleration = KEYS.iter().position(|key| *key == "K_delta_dd").unwrap();
    four.rows.iter_mut().for_each(|row| row.gains.0[steer_acceleration] = 0.0);
    bench.write("four.toml", four.to_toml());
    let check = bench.run("rider check four.toml").stdout;
    assert!(check.contains("gains mean: 5 points, unstable at 8 of 8 speeds\n"), "{check}");
    for law in ["none", "h"] {
        let basin =
            |rider: &str| bench.run(&format!("basin --speeds 2:5:1 --law {law} --rider {rider}")).stdout;
        let (sound, none) = (basin(&example), basin("four.toml"));
        let area = sound.lines().find_map(|line| line.strip_prefix("area ")).expect("an area");
        let area: f64 = area.split(' ').next().unwrap().parse().expect("a number");
        assert!((20.0..45.0).contains(&area) && !sound.contains("note:"), "{sound}");
        let note = format!(
            "height 0 at 2 to 5 m/s, 4 speeds; the linear loop of rider four.toml with law {law} is unstable at 4 of them"
        );
        assert!(none.contains("area 0.000 ") && none.contains(&note), "{none}");
    }
}
