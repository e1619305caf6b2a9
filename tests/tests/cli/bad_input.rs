//! Errors for invalid input, and the files that stay unchanged.
#![cfg(unix)]

use tests::cli::{Bench, Run, bicycle_with, repository, word};

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

/// Runs a command that must be rejected, with an older file where its document would go; that file must survive and
/// no other appear.
fn assert_rejected(bench: &Bench, line: &str, named: &[&str]) -> Run {
    bench.write("old.json", "older result");
    let before = bench.files();
    let run = bench.run(&format!("{line} --json old.json"));
    run.rejected_naming(named);
    assert_eq!(bench.files(), before, "{line}");
    assert_eq!(bench.read("old.json"), "older result", "{line}");
    run
}

/// Situation: parameter files with one error each.
/// Action: use them.
/// Must hold: rejected, naming file, key, value and range; nothing written.
#[test]
fn wrong_parameter_files() {
    let bench = Bench::new(PROGRAM);
    for (key, line, named) in [
        ("mB", "mB = -5", &["`mB` = -5", "0.001 to 1000 kg"][..]),
        ("mB", "mB = nan", &["`mB` = NaN", "0.001 to 1000 kg"]),
        ("mB", "mB = inf", &["`mB` = inf", "0.001 to 1000 kg"]),
        ("mB", "mB = '85'", &["`mB`", "number", "\"85\""]),
        ("mB", "", &["`mB` is missing", "0.001 to 1000 kg"]),
        ("mB", "mB = ", &["not valid TOML", "line 27"]),
        ("mB", "mb = 85.0", &["unknown key `mb`", "mB"]),
        ("w", "w = 0", &["`w` = 0", "0.1 to 5 m"]),
        ("zB", "zB = 0.9", &["`zB` = 0.9", "-5 to -0.001 m"]),
        ("lam", "lam = 18", &["`lam` = 18", "-1 to 1.4 rad"]),
        ("IBxz", "IBxz = 50", &["`IBxz` = 50", "`IBxx` = 9.2", "`IBzz` = 2.8", "below 5.075"]),
        ("IFxx", "IFxx = -0.1", &["`IFxx` = -0.1", "kg m^2"]),
    ] {
        bench.write("my.toml", bicycle_with(key, line));
        for command in ["bicycle check", "eigen --speeds 4", "ride --speed 4", "basin --speeds 4"] {
            let named: Vec<&str> = named.iter().copied().chain(["my.toml"]).collect();
            assert_rejected(&bench, &format!("{command} --bicycle my.toml"), &named);
        }
    }
    bench.write("bytes.toml", [0xff, 0x00, 0xfe]);
    assert_rejected(&bench, "eigen --bicycle bytes.toml", &["bytes.toml", "UTF-8"]);
    bench.write("empty.toml", "");
    assert_rejected(&bench, "eigen --bicycle empty.toml", &["empty.toml", "`w` is missing"]);
}

/// Situation: arrays with a number too many, in a scenario in TOML and in JSON and in a sensor model.
/// Action: use them.
/// Must hold: rejected with the file and the length; the TOML parser leaves out what is too many.
#[test]
fn longer_arrays_than_expected_are_rejected() {
    let bench = Bench::new(PROGRAM);
    bench.write("long.toml", "taper_m_s = [1.0, 2.0, 3.0]\n");
    bench.write("long.json", r#"{"taper_m_s": [1.0, 2.0, 3.0]}"#);
    for name in ["long.toml", "long.json"] {
        assert_rejected(&bench, &format!("ride --scenario {name} --speed 4"), &[name, "taper_m_s", "length"]);
    }
    let shipped = std::fs::read_to_string(repository("data/sensors/encoders-robot.toml")).unwrap();
    for longer in ["jitter_s = [1e-3, ", "vibration = [[1e-3, 1e-3, 1e-3, 1e-3, 1e-3]]\njitter_s = ["] {
        bench.write("sensor.toml", shipped.replacen("jitter_s = [", longer, 1));
        assert_rejected(
            &bench,
            "ride --speed 4 --preset product --sensor sensor.toml",
            &["sensor.toml", "length"],
        );
    }
}

/// Situation: a file of nothing, one of a remark, and such with the keys that are not values.
/// Action: give it to each option that reads a file.
/// Must hold: rejected with the file, and with what is expected; nothing of it is repeated.
#[test]
fn empty_files_are_rejected() {
    let bench = Bench::new(PROGRAM);
    let about = "source = 'x'\nlicence = 'y'\ncommand = 'z'\n";
    for (option, text, expected) in [
        ("--scenario", "", "expected those of a scenario"),
        ("--scenario", "# nothing yet\n", "expected those of a scenario"),
        ("--scenario", "{}\n", "expected those of a scenario"),
        ("--actuator", "", "for example limit_nm = 12"),
        ("--actuator", "source = 'x'\n", "for example limit_nm = 12"),
        ("--sensor", "", "source"),
        ("--sensor", about, "gyro, accel, steer, steer-rate, wheel, rider-torque, motor-report"),
        ("--parameters", "", "neither `law` nor `parameters`"),
        ("--rider", "", "missing field"),
        ("--law", "", "speed_m_s"),
        ("--bicycle", "", "`w` is missing"),
    ] {
        bench.write("empty", text);
        let run = bench.run(&format!("ride --speed 4 {option} empty"));
        run.rejected_naming(&["empty", expected]);
        assert!(!run.stderr.contains("empty: empty"), "{}", run.stderr);
    }
}

/// Situation: devices without an end, and a pipe.
/// Action: use them where a text file or a recording is expected.
/// Must hold: each device is rejected with its name and nothing written; the pipe is read.
#[test]
fn devices_are_no_files() {
    let bench = Bench::new(PROGRAM);
    for line in [
        "ride --speed 4 --law /dev/full",
        "ride --speed 4 --scenario /dev/full",
        "ride --speed 4 --bicycle /dev/full",
        "ride --speed 4 --rider /dev/full",
        "ride --speed 4 --actuator /dev/full",
        "ride --speed 4 --sensor /dev/full",
        "ride --speed 4 --parameters /dev/full",
        "basin compare /dev/full",
        "replay /dev/full",
        "replay /dev/full --map /dev/full",
        "identify /dev/full",
    ] {
        assert_rejected(&bench, line, &["/dev/full", "is a device, not a file"]);
    }
    let bicycle = word(&repository("data/bicycles/example.toml"));
    let run = bench.shell(&format!("cat {bicycle} | \"$0\" eigen --speeds 4 --bicycle /dev/stdin"));
    assert_eq!(run.code, Some(0), "{run:?}");
}

/// Situation: a table of states whose last line has no end, and the same with it.
/// Action: `bicycle accel`.
/// Must hold: the same rows; a warning with file and line for the first only.
#[test]
fn a_cut_table_of_states_causes_a_warning() {
    let bench = Bench::new(PROGRAM);
    let text =
        "roll,steer,roll_rate,steer_rate,rear_wheel_rate,roll_torque,steer_torque\n0.1,0,0,0,-10,0,0.25";
    bench.write("cut.csv", text);
    bench.write("whole.csv", format!("{text}\n"));
    let [cut, whole] = ["cut", "whole"]
        .map(|name| bench.run(&format!("bicycle accel --bicycle benchmark --states {name}.csv")));
    assert_eq!((cut.code, whole.code, &cut.stdout), (Some(0), Some(0), &whole.stdout));
    assert!(cut.stderr.contains("cut.csv: line 2: the last line has no end"), "{}", cut.stderr);
    assert_eq!(whole.stderr, "");
}

/// Situation: a bicycle with inertias that no rigid body has.
/// Action: check it, and ride it.
/// Must hold: a warning with the reason and the values, in the document too; it still runs.
#[test]
fn impossible_inertias_cause_a_warning() {
    let bench = Bench::new(PROGRAM);
    bench.write("my.toml", bicycle_with("IByy", "IByy = 50.0"));
    for command in ["bicycle check", "eigen --speeds 4", "ride --speed 4", "basin --speeds 4 --max-rate 1"] {
        let run = bench.run(&format!("{command} --bicycle my.toml"));
        assert_eq!(run.code, Some(0));
        for word in ["warning: my.toml: IB", "50.0", "triangle inequality"] {
            assert!(run.stderr.contains(word), "{command}: {}", run.stderr);
        }
    }
    let document = bench.json("bicycle check --bicycle my.toml");
    assert!(document["bicycle"]["warnings"][0].as_str().unwrap().contains("triangle inequality"));
}

/// Situation: bicycles that do not exist, and collections without a choice.
/// Action: use them.
/// Must hold: rejected, with the available names.
#[test]
fn unknown_bicycles() {
    let bench = Bench::new(PROGRAM);
    assert_rejected(&bench, "eigen --bicycle unicycle", &["`unicycle`", "rigid_jason", "benchmark"]);
    assert_rejected(&bench, "eigen --bicycle missing.toml#x", &["missing.toml"]);
    assert_rejected(&bench, "eigen --bicycle .", &["."]);
    let path = repository("data/bicycles.toml");
    let collection = word(&path);
    let name = path.display().to_string();
    assert_rejected(&bench, &format!("eigen --bicycle {collection}"), &[&name, "#NAME", "benchmark"]);
    assert_rejected(&bench, &format!("eigen --bicycle {collection}#unicycle"), &["#NAME", "benchmark"]);
    bench.write("my.toml", bicycle_with("w", "w = 1.1"));
    assert_rejected(&bench, "eigen --bicycle my.toml#city", &["my.toml", "city"]);
}

/// Situation: the help of the commands that take a law, and the documents.
/// Action: read them.
/// Must hold: they name every law that is chosen by name, as a law's error message does; the glossary has all laws.
#[test]
fn help_and_documents_name_every_law() {
    let bench = Bench::new(PROGRAM);
    let help = ["basin", "eigen"].map(|command| bench.run(&format!("{command} --help")).stdout);
    let page = |name: &str| std::fs::read_to_string(repository(name)).expect("a page");
    let (table, glossary) = (page("docs/cli.md"), page("docs/glossary.md"));
    let laws = glossary.lines().find(|row| row.starts_with("| law |")).expect("a row");
    for name in control::law::LAW_NAMES {
        assert!(laws.contains(&format!("`{name}`")), "docs/glossary.md: {name}");
    }
    for spec in control::law::LAWS.iter().filter(|spec| !spec.is_table()) {
        let name = if spec.parameter.is_some() { format!("{}:K", spec.name) } else { spec.name.to_owned() };
        assert!(help.iter().all(|help| help.contains(&format!(" {name},"))), "{name}: {help:?}");
        assert!(table.contains(&format!("| `{name}` |")), "docs/cli.md: {name}");
        assert_rejected(&bench, "eigen --law nope", &[&name]);
    }
}

/// Situation: laws that do not exist or are wrong.
/// Action: use them.
/// Must hold: rejected, naming law or file, key, value and range.
#[test]
fn wrong_laws() {
    let bench = Bench::new(PROGRAM);
    assert_rejected(&bench, "eigen --law H", &["`H`", "h-cut", "cl2:K"]);
    assert_rejected(&bench, "eigen --law cl2:", &["`cl2:`", "0.001 to 20"]);
    assert_rejected(&bench, "eigen --law cl2:-1", &["`cl2:-1`", "-1", "0.001 to 20"]);
    assert_rejected(&bench, "eigen --law cl2:nan", &["`cl2:nan`", "NaN", "0.001 to 20"]);
    for (text, named) in [
        ("", &["speed_m_s"][..]),
        ("speed_m_s = [0]", &["gain_nm_s_rad"]),
        ("speed_m_s = [0, 1]\ngain_nm_s_rad = [1]", &["speed_m_s", "2", "gain_nm_s_rad", "1"]),
        ("speed_m_s = []\ngain_nm_s_rad = []", &["points", "1 to 32"]),
        ("speed_m_s = [5, 0]\ngain_nm_s_rad = [1, 1]", &["speed_m_s = 0", "5.001 to 30", "rise"]),
        ("speed_m_s = [0, 99]\ngain_nm_s_rad = [1, 1]", &["speed_m_s = 99", "to 30"]),
        ("speed_m_s = [0]\ngain_nm_s_rad = [1e9]", &["gain_nm_s_rad = 1000000000", "-200 to 200"]),
        ("speed_m_s = [nan]\ngain_nm_s_rad = [1]", &["speed_m_s = NaN"]),
        ("speed_m_s = ['a']\ngain_nm_s_rad = [1]", &["line 1", "\"a\""]),
        ("speed_m_s = [0]\ngain_nm_s_rad = [1]\ngains = 3", &["`gains`", "gain_nm_s_rad"]),
    ] {
        bench.write("law.toml", text);
        let named: Vec<&str> = named.iter().copied().chain(["law.toml"]).collect();
        assert_rejected(&bench, "eigen --law law.toml", &named);
    }
}

/// Situation: numbers out of their range: negative, huge, NaN.
/// Action: give them as options.
/// Must hold: rejected, naming the quantity, the value and the range.
#[test]
fn numbers_out_of_range() {
    let bench = Bench::new(PROGRAM);
    for (line, named) in [
        ("ride --speed -1", &["--speed", "-1", "0 to 30"][..]),
        ("ride --speed nan", &["--speed", "NaN", "0 to 30"]),
        ("ride --speed 4 --steer-rate 1e6", &["--steer-rate", "1000000", "-100 to 100"]),
        ("ride --speed 4 --roll-rate=-inf", &["--roll-rate", "-inf", "-100 to 100"]),
        ("ride --speed 4 --time-limit -6", &["time limit", "-6", "0.001 to 3600"]),
        ("ride --speed 4 --time-limit 0", &["time limit", "0", "0.001 to 3600"]),
        ("ride --speed 4 --time-limit 1e9", &["time limit", "1000000000", "0.001 to 3600"]),
        ("ride --speed 4 --recovered-below 2", &["recovered-below", "2", "to 1"]),
        ("ride --speed 4 --torque-limit -7", &["--torque-limit", "-7", "0.1 to 50"]),
        ("ride --speed 4 --torque-limit nan", &["--torque-limit", "NaN", "0.1 to 50"]),
        ("ride --speed 4 --rate-limit 0", &["--rate-limit", "0", "1 to 100000"]),
        ("ride --speed 4 --taper 3:1", &["--taper", "1", "3.1 to 10"]),
        ("ride --speed 4 --sensor-delay 1.5ms", &["--sensor-delay", "1.5 ms", "1 ms and 2 ms"]),
        ("ride --speed 4 --sensor-delay 5s", &["--sensor-delay", "5000 ms", "0 to 1000 ms"]),
        ("ride --speed 4 --assist ideal --torque-limit 7", &["limits", "ideal"]),
        ("ride --speed 4 --preset product --set rate_hz=100", &["input.max_gap_ms = 5", "10 to 1000"]),
        (
            "ride --speed 4 --preset product --set input.max_gap_ms=0.1",
            &["input.max_gap_ms = 0.1", "1 to 1000"],
        ),
        ("basin --speeds 4 --max-rate -1", &["max rate", "-1", "0.01 to 100"]),
        ("basin --speeds 4 --scan-step 0", &["scan step", "0", "0.001 to 30"]),
        ("basin --speeds 4 --tolerance -1", &["tolerance", "-1"]),
    ] {
        assert_rejected(&bench, line, named);
    }
    for (line, word) in [
        ("basin --speeds 10:0:0.1", "rise"),
        ("basin --speeds 0:10:0", "0.000001 m/s"),
        ("basin --speeds 0:40:1", "0 to 30"),
        ("basin --speeds -1", "0 to 30"),
        ("eigen --speeds 0:1:1e-6", "at most 100000"),
        ("basin --speeds a:b:c", "A:B:STEP"),
        ("ride --speed 4 --sensor-delay -5ms", "0 s to 3600 s"),
        ("ride --speed 4 --sensor-delay 5", "20ms"),
        ("basin --threads 0", "1..=1024"),
        ("basin --threads -1", "1..=1024"),
        ("thesis --threads -1", "1..=1024"),
        ("design --knots -1", "2..=8"),
        ("design --evaluations -1", "1..=1000000"),
        ("eigen --rider smart --roots -1", "4..=40"),
        ("basin --uncertain -1", "2..=10000"),
        ("faults --port none --baud -1", "300..=4000000"),
        ("ride --speed 4 --seed -1", "from 0 to 9223372036854775807"),
        ("design --seed -1", "from 0 to 9223372036854775807"),
        ("record --rider young --speed 4 --seed -1", "from 0 to 9223372036854775807"),
        ("replay ride.csv --fault gyro.x:nan@1s --seed -1", "from 0 to 9223372036854775807"),
        ("identify ride.csv --seed -1", "from 0 to 9223372036854775807"),
    ] {
        let run = bench.run(line);
        assert!(run.code == Some(2) && run.stderr.contains(word), "{line}: {}", run.stderr);
    }
}

/// Situation: a rider with muscles too quick for a delay of a second: no number of points resolves the roots.
/// Action: request eigenvalues.
/// Must hold: rejected with the reason.
#[test]
fn eigenvalues_that_do_not_converge() {
    let bench = Bench::new(PROGRAM);
    let text = "schema = 1\ndelay_ms = 1000\nneuromuscular = { omega_rad_s = 200, zeta = 0.707 }\n\
        columns = [\"speed_m_s\", \"K_phi_p\", \"K_phi_dd\", \"K_delta_dd\", \"K_y\"]\n\
        rows = [[4.0, 1000.0, 1000.0, 1000.0, 1000.0]]\n";
    bench.write("rider.toml", text);
    bench.run("eigen --rider rider.toml --speeds 4").rejected_naming(&["no eigenvalue converges", "20 m/s"]);
}

/// Situation: speed zero, and the largest disturbances allowed.
/// Action: ride and search.
/// Must hold: results, not errors; nothing in them is NaN.
#[test]
fn extremes_within_the_ranges_run() {
    let bench = Bench::new(PROGRAM);
    for line in [
        "ride --speed 0 --steer-rate 100",
        "ride --speed 30 --steer-rate -100 --roll-rate 100",
        "ride --speed 0 --law none --roll-rate 1e-300",
        "basin --speeds 0 --max-rate 100 --scan-step 20 --tolerance 5",
        "eigen --speeds 0:30:15 --law f",
    ] {
        let text = bench.json(line).to_string();
        assert!(!text.contains("NaN") && !text.contains("inf"), "{line}");
    }
}

/// Situation: tables of states with errors.
/// Action: request accelerations, into an older file.
/// Must hold: rejected, naming file, line, column, value and range; the older file survives.
#[test]
fn wrong_tables_of_states() {
    let bench = Bench::new(PROGRAM);
    let header = "roll,steer,roll_rate,steer_rate,rear_wheel_rate,roll_torque,steer_torque";
    for (text, named) in [
        (String::new(), &["`roll` is missing", "steer_torque"][..]),
        ("roll;steer\n".into(), &["`roll` is missing"]),
        (header.replace("steer_rate", "roll"), &["`roll` is listed twice"]),
        (format!("{header}\n0,0,0\n"), &["line: 2", "3 fields"]),
        (format!("{header}\n0,0,0,0,0,0,0\n0,x,0,0,0,0,0\n"), &["line 3", "`steer` = `x`", "-10 to 10"]),
        (format!("{header}\n1e300,0,0,0,0,0,0\n"), &["line 2", "`roll` = `1e300`", "-10 to 10"]),
        (format!("{header}\n0,0,0,0,nan,0,0\n"), &["`rear_wheel_rate` = `nan`", "-10000 to 10000"]),
        (format!("{header}\n1.5707963267948966,0,0,0,0,0,0\n"), &["line 2", "front wheel"]),
    ] {
        bench.write("in.csv", text);
        bench.write("old.csv", "older result");
        let named: Vec<&str> = named.iter().copied().chain(["in.csv"]).collect();
        bench.run("bicycle accel --states in.csv --csv old.csv").rejected_naming(&named);
        assert_eq!((bench.read("old.csv").as_str(), bench.files().len()), ("older result", 2));
    }
    bench.run("bicycle accel --states missing.csv").rejected_naming(&["missing.csv"]);
}

/// Situation: paths that cannot be written, and one path for two results.
/// Action: name them as outputs of every kind.
/// Must hold: rejected before any work, naming the path and the reason; no file appears.
#[test]
fn outputs_that_can_not_be() {
    let bench = Bench::new(PROGRAM);
    bench.write("file", "");
    std::fs::create_dir(bench.path("folder")).unwrap();
    std::os::unix::fs::symlink("nowhere", bench.path("link")).unwrap();
    let before = bench.files();
    for option in ["--json", "--csv", "--svg", "--png"] {
        for (place, reason) in [
            ("missing/out", "no folder missing"),
            ("folder", "folder"),
            ("file/out", "no folder file"),
            ("link", "dangling symlink"),
        ] {
            // Longer than any test may take, if the path were checked only at the end.
            let line = format!("basin --time-limit 3600 --speeds 6:7:0.01 {option} {place}");
            bench.run(&line).rejected_naming(&[place, reason]);
        }
    }
    bench.run("ride --speed 4 --csv out --json ./out").rejected_naming(&["--csv", "--json", "same place"]);
    bench.run("ride --speed 4 --csv out --frames out").rejected_naming(&["--csv", "--frames", "same place"]);
    bench.run("ride --speed 4 --csv - --json").rejected_naming(&["--csv", "--json", "same place"]);
    for standard in ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"] {
        let line = format!("ride --speed 4 --csv - --json {standard}");
        bench.run(&line).rejected_naming(&["--csv", "--json", "same place"]);
    }
    let run = bench.run("ride --speed 4 --csv /dev/stderr --json /dev/fd/2");
    run.rejected_naming(&["--csv", "--json", "same place"]);
    assert_eq!(bench.files(), before);
}
