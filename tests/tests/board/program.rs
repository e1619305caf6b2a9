//! The program, on a board at a serial port.

use control::{Config, GainSchedule, Law};
use link::frame::VERSION;
use link::message::Message;
use serde_json::Value;
use std::io::{BufRead, BufReader, Read};
use std::os::unix::fs::symlink;
use std::process::{Command, Stdio};
use tests::cli::{Bench, Run, repository};
use tests::json_schema::violations;
use tests::link_board::{LinkBoard, Shared, faults, lock, shared, telemetry};
use tests::pty::Port;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

/// A board that sends a step whenever its line is read, 20 ms of its own time apart.
fn sending(board: &Shared) -> Port {
    let mut steps = 0;
    Port::new(board, move |board| {
        steps += 20;
        Some(lock(board).unsolicited(&Message::Telemetry(telemetry(steps))))
    })
}

fn done(run: &Run) -> &str {
    assert_eq!(run.code, Some(0), "{run:?}");
    &run.stdout
}

/// Situation: a board that sends telemetry.
/// Action: list, get, set, store, reset.
/// Must hold: each shows the board's values; a set is reported with the old value, in force and not stored; then it
/// is stored.
#[test]
fn a_parameter_is_read_set_and_stored() {
    let (bench, board) = (Bench::new(PROGRAM), shared(LinkBoard::default()));
    let port = sending(&board);
    let run = |line: &str| bench.run(&format!("param {line} --port {}", port.name));
    let all = run("list");
    let mut listed = 0;
    link::parameter_list::each(&mut Config::product(), |parameter| {
        listed += 1;
        parameter.value
    });
    assert_eq!(done(&all).lines().count(), 1 + listed, "the board, and each parameter");
    let taper = run("list taper");
    assert!(done(&taper).contains("limits.taper.zero_m_s") && !taper.stdout.contains("rate_hz"));
    let got = run("get limits.max_torque_nm");
    assert!(done(&got).contains("7 N m") && got.stdout.contains("0.1 to 50 or none"), "{}", got.stdout);
    let set = run("set limits.max_torque_nm 5");
    assert!(done(&set).contains("limits.max_torque_nm = 5 (was 7)") && set.stdout.contains("not stored"));
    assert_eq!(lock(&board).config.limits.max_torque_nm, Some(5.0));
    assert!(lock(&board).stored.is_none());
    let got = run("get limits.max_torque_nm");
    assert!(done(&got).contains("; default 7"), "{}", got.stdout);
    assert!(done(&run("set law cl2:3")).contains("law = cl2:3 (was h-cut)"));
    assert!(done(&run("set law.cl2.k 2.5")).contains("law.cl2.k = 2.5 (was 3)"));
    assert!(done(&run("set calibration.gyro_bias_x_rad_s -0.01")).contains("(was 0)"));
    assert_eq!(lock(&board).config.law, Law::Cl2 { k: 2.5 });
    assert_eq!(done(&run("store")), "stored\n");
    assert_eq!(lock(&board).stored.as_ref().map(|stored| stored.law.clone()), Some(Law::Cl2 { k: 2.5 }));
    assert!(done(&run("reset")).contains("defaults"));
    assert_eq!(lock(&board).config, Config::product());
}

/// Situation: a board with the flashed configuration, and no board.
/// Action: list the parameters of both, all and some, as text and as a document.
/// Must hold: the same lines after the first, which names the board or the configuration; the same document except the board, which
/// is null, and which fits the schema.
#[test]
fn the_flashed_parameters_are_listed_without_a_board() {
    let (bench, board) = (Bench::new(PROGRAM), shared(LinkBoard::default()));
    let port = Port::quiet(&board);
    let [of_board, defaults] = [format!("--port {}", port.name), "--defaults".into()];
    for filter in ["", "limits"] {
        let lines = |from: &str| {
            let text = done(&bench.run(&format!("param list {from} {filter}"))).to_owned();
            text.split_once('\n').map(|(first, rest)| (first.to_owned(), rest.to_owned())).expect("lines")
        };
        assert_eq!(lines(&of_board).1, lines(&defaults).1);
        assert_eq!(lines(&defaults).0, "# flashed configuration");
    }
    let [mut of_board, document] = [of_board, defaults].map(|from| bench.json(&format!("param list {from}")));
    assert!(of_board["board"].take().is_object());
    assert_eq!(of_board, document);
    assert_eq!(violations(&schema("param-list"), &document), [""; 0]);
    bench.run("param list --defaults nonsense").rejected_naming(&["`nonsense`"]);
    assert_eq!(bench.run("param list --defaults --qemu").code, Some(2));
}

/// Situation: an unknown key, invalid values, a board that is engaged, no board, no such port.
/// Action: run.
/// Must hold: exit code 1 and the reason, with key, value and allowed range; usage is 2; nothing set.
#[test]
fn bad_input_is_named() {
    let (bench, board) = (Bench::new(PROGRAM), shared(LinkBoard::default()));
    let port = Port::quiet(&board);
    let run = |line: &str| bench.run(&format!("param {line} --port {}", port.name));
    run("get limits.nonsense").rejected_naming(&["no parameter limits.nonsense", "param list"]);
    run("list nonsense").rejected_naming(&["`nonsense`"]);
    run("set limits.max_torque_nm 70").rejected_naming(&["limits.max_torque_nm = 70", "0.1 to 50 or none"]);
    run("set limits.max_torque_nm off").rejected_naming(&["`off` is no number", "0.1 to 50 or none"]);
    run("set limits.end_stop maybe").rejected_naming(&["limits.end_stop = `maybe`", "off, on"]);
    run("set input.wheel left").rejected_naming(&["input.wheel", "front, rear"]);
    run("set law cl3").rejected_naming(&["unknown law `cl3`", "h-cut"]);
    run("set limits.taper.zero_m_s 9")
        .rejected_naming(&["limits.taper.full_m_s = 1.5 is outside 9.1 to 10", "nothing is set"]);
    lock(&board).engaged = true;
    for line in ["set limits.max_torque_nm 5", "store", "reset"] {
        run(line).rejected_naming(&["rejected while engaged"]);
    }
    assert_eq!(lock(&board).config, Config::product());
    bench.run("param list --port /no/such/port").rejected_naming(&["can't open /no/such/port"]);
    bench.write("noise.link", [7; 100]);
    for usage in [
        "param list",
        "monitor",
        "faults",
        "param list --port x --baud 7",
        "monitor --file a --port b",
        "faults --file a --clear",
    ] {
        assert_eq!(bench.run(usage).code, Some(2), "{usage}");
    }
    lock(&board).version = 3;
    let versions = format!("the board uses version 3 of the link, this program version {VERSION}:");
    run("list").rejected_naming(&[&versions]);
}

/// Situation: a board with a law of points and its own values.
/// Action: export; reset; import; export again; ride the simulator with the file.
/// Must hold: the board has its former values; the files are the same except the line that names the board; the ride
/// has law and parameters of the file, and its own calibration.
#[test]
fn an_export_is_imported_and_ridden() {
    let (bench, board) = (Bench::new(PROGRAM), shared(LinkBoard::default()));
    let mut config = Config::product();
    config.law = Law::Table(GainSchedule::new(&[(0.0, 12.0), (2.7, 8.1), (6.0, 0.0)]).expect("a table"));
    (config.limits.max_torque_nm, config.limits.end_stop) = (Some(0.3 + 4.0), None);
    config.calibration.gyro_bias_rad_s[0] = 0.012;
    config.calibration.motor_reversed = true;
    lock(&board).config = config.clone();
    let port = Port::quiet(&board);
    let run = |line: &str| bench.run(&format!("param {line} --port {}", port.name));
    done(&run("export board.toml"));
    done(&run("reset"));
    let imported = run("import board.toml");
    assert!(done(&imported).contains("limits.end_stop = off (was on)"), "{}", imported.stdout);
    assert_eq!(lock(&board).config, config);
    assert!(done(&run("import board.toml")).contains("nothing to set"));
    let again = run("export");
    let body = |text: &str| text.split_once('\n').map(|(_, body)| body.to_owned()).expect("lines");
    assert_eq!(body(done(&again)), body(&bench.read("board.toml")));
    let ride = bench.json("ride --speed 4 --steer-rate 2 --parameters board.toml");
    assert_eq!(ride["config"]["law"]["points"][1], serde_json::json!([2.7, 8.1]));
    assert_eq!(ride["config"]["torque_limit_nm"], 4.3);
    assert!(ride["config"]["parameters"]["calibration.motor_reversed"].is_null());
    let without = bench.json(
        "ride --speed 4 --steer-rate 2 --parameters board.toml --set limits.max_torque_nm=2 --law none",
    );
    assert_eq!(without["config"]["law"]["name"], "none");
    lock(&board).config.calibration.polarity_checked = true;
    done(&run("export checked.toml"));
    lock(&board).config.calibration.polarity_checked = false;
    let unchecked = run("import checked.toml");
    done(&unchecked);
    assert!(unchecked.stderr.contains("note: calibration.polarity_checked is off"), "{}", unchecked.stderr);
}

/// Situation: files that are no TOML, have unknown keys, values out of range, a law among the parameters.
/// Action: import each; ride the simulator with each.
/// Must hold: rejected with file, key and value; nothing set, though other values in the file are right.
#[test]
fn an_invalid_file_sets_nothing() {
    let (bench, board) = (Bench::new(PROGRAM), shared(LinkBoard::default()));
    let port = Port::quiet(&board);
    for (text, named) in [
        ("law = h", &["wrong.toml"][..]),
        ("laws = \"h\"", &["wrong.toml", "laws"]),
        ("law = \"cl9\"", &["wrong.toml", "cl9"]),
        ("law = 3", &["wrong.toml", "law"]),
        ("[law]\nspeed_m_s = [1, 0]\ngain_nm_s_rad = [1, 2]\n", &["wrong.toml", "rise"]),
        ("[parameters]\n\"law.cl2.k\" = 3\n", &["wrong.toml", "law.cl2.k", "above"]),
        ("[parameters]\nrate_hz = [1]\n", &["wrong.toml", "rate_hz", "array"]),
        (
            "[parameters]\n\"limits.fall_nm_s\" = 50\n\"limits.nonsense\" = 3\n",
            &["wrong.toml", "limits.nonsense"],
        ),
        (
            "[parameters]\n\"limits.fall_nm_s\" = 50\n\"limits.max_torque_nm\" = 70\n",
            &["wrong.toml", "limits.max_torque_nm = 70", "0.1 to 50"],
        ),
        ("[parameters]\nrate_hz = \"on\"\n", &["wrong.toml", "rate_hz", "`on`"]),
    ] {
        bench.write("wrong.toml", text);
        bench.run(&format!("param import wrong.toml --port {}", port.name)).rejected_naming(named);
        bench.run("ride --speed 4 --parameters wrong.toml").rejected_naming(named);
        assert_eq!(lock(&board).config, Config::product(), "{text}");
    }
    bench.run(&format!("param import missing.toml --port {}", port.name)).rejected_naming(&["missing.toml"]);
}

/// Situation: a board that is unplugged after its fourth setting.
/// Action: import a file that sets eight.
/// Must hold: exit code 1, not that of a closed output; the output lists what was set, what was not and the unknown
/// one.
#[test]
fn a_board_unplugged_during_an_import_is_reported() {
    let (bench, board) = (Bench::new(PROGRAM), shared(LinkBoard::default()));
    let values: Vec<_> = (0..8).map(|i| format!("\"{}\" = {}\n", KEYS[i], i + 1)).collect();
    bench.write("eight.toml", format!("[parameters]\n{}", values.concat()));
    let mut requests = None;
    let port = Port::new(&board, move |board| {
        let board = lock(board);
        let changed = board.config != Config::product();
        let begun = *requests.get_or_insert(board.requests);
        requests = Some(if changed { begun } else { board.requests });
        (board.requests < begun + 4).then(Vec::new)
    });
    let run = bench.run(&format!("param import eight.toml --port {}", port.name));
    run.rejected_naming(&["lost /dev/", "set: ", "not known: ", "not set: ", "can't be read back"]);
}

const KEYS: [&str; 8] = [
    "limits.rise_nm_s",
    "limits.fall_nm_s",
    "limits.max_torque_nm",
    "limits.rider_torque.allowance_nm",
    "limits.rider_torque.multiplier",
    "limits.rider_motion.steer_rate_rad_s",
    "limits.taper.full_m_s",
    "permit.ramp_in_ticks",
];

/// Situation: a board with a fault of every kind.
/// Action: faults, as text and JSON; with --clear; again.
/// Must hold: all described in text, newest first; then none.
#[test]
fn faults_are_listed_and_cleared() {
    let (bench, board) =
        (Bench::new(PROGRAM), shared(LinkBoard { faults: faults(), ..LinkBoard::default() }));
    let port = sending(&board);
    let line = format!("faults --port {}", port.name);
    let document = bench.json(&line);
    assert_eq!(violations(&schema("faults"), &document), [""; 0]);
    assert_eq!(document["faults"][3]["exception"]["bfar"], "deadbeef");
    let text = bench.run(&format!("{line} --clear"));
    let kinds =
        ["controller in start 5", "brown-out", "watchdog", "exception in", "panic", "drive in start 1"];
    let places: Vec<_> = kinds.iter().map(|kind| done(&text).find(kind).expect("listed")).collect();
    assert!(places.is_sorted(), "{}", text.stdout);
    assert_eq!(done(&bench.run(&line)), "no faults\n");
}

fn schema(name: &str) -> Value {
    let text = std::fs::read_to_string(repository(&format!("docs/schema/{name}.json"))).expect("a schema");
    serde_json::from_str(&text).expect("JSON")
}

/// Situation: the documents of `param list` and `faults`.
/// Action: compare them with the committed schemas, and these with the program's own.
/// Must hold: they are valid; the schemas are the same.
#[test]
fn documents_fit_their_committed_schemas() {
    let (bench, board) = (Bench::new(PROGRAM), shared(LinkBoard::default()));
    let port = Port::quiet(&board);
    let document = bench.json(&format!("param list limits --port {}", port.name));
    assert_eq!(violations(&schema("param-list"), &document), [""; 0]);
    assert_eq!(document["parameters"][0]["key"], "limits.max_torque_nm");
    for name in ["param-list", "faults"] {
        let own = bench.run(&format!("schema {name}"));
        let file =
            std::fs::read_to_string(repository(&format!("docs/schema/{name}.json"))).expect("a schema");
        assert!(own.stdout == file, "run: sim-host schema {name} > docs/schema/{name}.json");
    }
}

/// Situation: a board that sends steps and a fault.
/// Action: monitor for four seconds with table and recording; then monitor the recording, and list its faults.
/// Must hold: lines with mode, causes with their pages and limits; the table of the recording is that of the ride
/// except for its source; the fault is in it.
#[test]
fn a_ride_is_monitored_recorded_and_monitored_again() {
    let (bench, board) = (Bench::new(PROGRAM), shared(LinkBoard::default()));
    let mut steps = 0;
    let port = Port::new(&board, move |board| {
        steps += 20;
        let mut bytes = lock(board).unsolicited(&Message::Telemetry(telemetry(steps)));
        if steps == 400 {
            bytes.extend(lock(board).unsolicited(&Message::Fault(faults()[0])));
        }
        Some(bytes)
    });
    let live = bench.run(&format!("monitor --port {} --for 4s --csv live.csv --record ride.link", port.name));
    for word in [
        "fake 0.1.0 commit 0123456789ab",
        " s engaged, torque 1.50 N m, gain 6.00",
        "roll rate 0.25 rad/s, speed front 4.00 rear -",
        "limits rate, causes 17 FrontWheelLost + 46 PolarityUnchecked, late 2",
        "docs/faults/46-polarity-unchecked.md",
        "fault: controller in start 5",
        " 0 damaged, 0 restarts",
    ] {
        assert!(done(&live).contains(word), "no `{word}` in {}", live.stdout);
    }
    let replayed = bench.run("monitor --file ride.link --csv replayed.csv");
    assert!(
        done(&replayed).contains("a recording") && replayed.stdout.contains("0 damaged"),
        "{}",
        replayed.stdout
    );
    let rows = |name: &str| bench.read(name).lines().skip(2).map(String::from).collect::<Vec<_>>();
    assert_eq!(rows("live.csv"), rows("replayed.csv"));
    assert!(rows("live.csv").len() > 10 && rows("live.csv")[0].starts_with("t,steps,late,"));
    assert!(
        bench.read("live.csv").starts_with("# sim-host ")
            && bench.read("live.csv").contains("\"image\":\"fake\"")
    );
    let faults = bench.json("faults --file ride.link");
    assert_eq!((faults["faults"][0]["kind"].as_str(), &faults["board"]), (Some("controller"), &Value::Null));
    let table = bench.run("monitor --file ride.link --csv -");
    assert_eq!(done(&table).lines().skip(2).collect::<Vec<_>>(), rows("live.csv"));
    bench
        .run(&format!("monitor --port {} --csv same --record same", port.name))
        .rejected_naming(&["--csv and --record"]);
    bench.run("monitor --file ride.link --csv no/such/folder.csv").rejected_naming(&["no/such"]);
}

/// Situation: a recording with changed bytes, one that is noise, one that is missing.
/// Action: monitor each.
/// Must hold: complete frames are reported, others counted; noise has no frames; a missing file is named.
#[test]
fn valid_frames_of_a_damaged_recording_are_read() {
    let bench = Bench::new(PROGRAM);
    let mut board = LinkBoard::default();
    let mut bytes: Vec<u8> =
        (1..=100).flat_map(|i| board.unsolicited(&Message::Telemetry(telemetry(20 * i)))).collect();
    for frame in [10, 20, 30] {
        bytes[frame * 128 + 60] ^= 0x11;
    }
    bench.write("ride.link", bytes);
    let run = bench.run("monitor --file ride.link");
    assert!(
        run.stdout.ends_with("97 frames, 3 missing, 3 damaged, 0 restarts; the board's clock at 2.000 s\n"),
        "{}",
        run.stdout
    );
    assert_eq!(run.code, Some(3));
    assert!(run.stderr.contains("3 frames damaged"), "{}", run.stderr);
    bench.write("noise.link", (0..5000_u32).map(|i| (i * i / 7) as u8).collect::<Vec<_>>());
    let noise = bench.run("monitor --file noise.link");
    assert!(
        noise.code == Some(1) && noise.stderr.contains("noise.link: no whole frame of the link"),
        "{noise:?}"
    );
    assert!(noise.stdout.contains("\n0 frames, 0 missing, "), "{}", noise.stdout);
    bench.run("monitor --file missing.link").rejected_naming(&["can't open missing.link"]);
}

/// Situation: a monitor with table and recording, some of it written.
/// Action: Ctrl-C.
/// Must hold: exit code 130; the summary; whole lines in the table, as many as whole frames in the recording.
#[test]
fn ctrl_c_ends_a_monitor_with_complete_files() {
    let (bench, board) = (Bench::new(PROGRAM), shared(LinkBoard::default()));
    let port = sending(&board);
    let mut command =
        bench.command(&format!("monitor --port {} --csv ride.csv --record ride.link", port.name));
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    let mut received = [0; 300];
    let out = child.stdout.as_mut().expect("piped");
    out.read_exact(&mut received).expect("output");
    let kill = Command::new("sh").args(["-c", &format!("kill -INT {}", child.id())]).status();
    assert!(kill.expect("sh runs").success());
    let run = Run::from(child.wait_with_output().expect("it ends"));
    assert_eq!(run.code, Some(130), "{run:?}");
    assert!(run.stdout.contains(", 0 missing, 0 damaged"), "{}", run.stdout);
    assert!(run.stderr.contains("interrupted: ending"), "{}", run.stderr);
    let table = bench.read("ride.csv");
    assert!(table.ends_with('\n') && table.lines().count() > 3);
    done(&bench.run("monitor --file ride.link --csv replayed.csv"));
    assert_eq!(bench.read("replayed.csv").lines().count(), table.lines().count());
}

/// A board that is unplugged after 50 monitored steps, from `steps` on.
fn pulled_out(board: &Shared, mut steps: u32) -> Port {
    let last = steps + 1000;
    let requests = lock(board).requests;
    Port::new(board, move |board| {
        let monitored = lock(board).requests > requests;
        if !monitored {
            return Some(Vec::new());
        }
        steps += 20;
        (steps < last).then(|| lock(board).unsolicited(&Message::Telemetry(telemetry(steps))))
    })
}

/// Situation: a board that is unplugged while it is monitored.
/// Action: monitor, without waiting and waiting a second.
/// Must hold: exit code 1, the line named, and the time if it was waited for; the summary printed, the table
/// complete.
#[test]
fn a_board_unplugged_while_monitored_is_reported() {
    for (reopen, received) in [("0s", ""), ("1s", "; not back within 1 s")] {
        let (bench, board) = (Bench::new(PROGRAM), shared(LinkBoard::default()));
        let port = pulled_out(&board, 0);
        let run = bench.run(&format!("monitor --port {} --csv ride.csv --reopen {reopen}", port.name));
        assert_eq!(run.code, Some(1), "{run:?}");
        assert!(run.stderr.starts_with("error: lost /dev/"), "{}", run.stderr);
        assert!(run.stderr.trim_end().ends_with(received), "{}", run.stderr);
        assert_eq!(run.stdout.contains("waiting up to 1 s for it"), !received.is_empty(), "{}", run.stdout);
        assert!(run.stdout.contains(" 0 missing, 0 damaged"), "{}", run.stdout);
        assert!((5..=60).contains(&bench.read("ride.csv").lines().count()));
    }
}

/// Situation: a board that is unplugged while it is monitored and recorded, and plugged in again at another device,
/// to which the port's name then leads.
/// Action: monitor; unplug it for good.
/// Must hold: loss, return and identity are reported; table and recording have the steps of both times, and no more.
#[test]
fn a_board_that_returns_is_monitored_again() {
    let (bench, board) = (Bench::new(PROGRAM), shared(LinkBoard::default()));
    let first = pulled_out(&board, 0);
    symlink(&first.name, bench.path("port")).expect("a link");
    let texts = "monitor --port port --csv ride.csv --record ride.link --reopen 10s";
    let mut command = bench.command(texts);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    let mut lines =
        BufReader::new(child.stdout.take().expect("piped")).lines().map(|line| line.expect("text"));
    assert!(lines.any(|line| line.starts_with("lost port: ") && line.ends_with("waiting up to 10 s for it")));
    let second = pulled_out(&board, 2000);
    std::fs::remove_file(bench.path("port")).expect("the link");
    symlink(&second.name, bench.path("port")).expect("a link");
    let rest: Vec<String> = lines.collect();
    let run = Run::from(child.wait_with_output().expect("it ends"));
    assert_eq!(run.code, Some(1), "{run:?}");
    let back = rest.iter().find(|line| line.starts_with("back after ")).unwrap_or_else(|| panic!("{rest:?}"));
    assert!(back.contains("fake 0.1.0 commit 0123456789ab"), "{back}");
    assert!(rest.last().is_some_and(|line| line.contains(" 0 restarts")), "{rest:?}");
    assert!(run.stderr.contains("not back within 10 s"), "{}", run.stderr);
    let table = bench.read("ride.csv");
    let of = |line: &str| line.split(',').nth(1).and_then(|steps| steps.parse::<u32>().ok());
    let steps: Vec<u32> =
        table.lines().skip(3).map(|line| of(line).unwrap_or_else(|| panic!("{line}"))).collect();
    assert!(steps.windows(2).all(|two| two[0] < two[1]), "{steps:?}");
    let (before, after) =
        steps.split_at(steps.iter().position(|steps| *steps > 2000).expect("of the second time"));
    assert!((5..=50).contains(&before.len()) && (5..=50).contains(&after.len()), "{steps:?}");
    done(&bench.run("monitor --file ride.link --csv replayed.csv"));
    assert_eq!(bench.read("replayed.csv").lines().count(), table.lines().count());
}
