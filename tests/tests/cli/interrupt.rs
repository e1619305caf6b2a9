//! Ctrl-C, SIGTERM and closed outputs.
#![cfg(target_os = "linux")]

use serde_json::Value;
use std::io::Read;
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tests::cli::{Bench, Run};
use tests::wait::{until_done, until_used};

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");
/// Many short columns, together far longer than the test's timeout.
const MANY: &str = "basin --speeds 0:30:0.0005 --time-limit 0.2 --scan-step 10 --tolerance 5";
/// One column that takes minutes.
const LONG: &str = "basin --speeds 6 --time-limit 3600 --max-rate 0.5 --scan-step 0.01";

/// A delayed rider with muscles so quick that its roots at all speeds of the search for stable ones take many seconds.
const QUICK_RIDER: &str = "schema = 1\ndelay_ms = 1000\nneuromuscular = { omega_rad_s = 100, zeta = 0.707 }\n\
    columns = [\"speed_m_s\", \"run\", \"group\", \"vaf\", \"K_phi_p\", \"K_phi_d\", \"K_phi_dd\", \"K_delta_p\", \"K_delta_d\", \
    \"K_delta_dd\", \"K_phi_i\", \"K_delta_i\", \"K_psi\", \"K_y\"]\n\
    rows = [[4.0, 1, 1, 90.0, 1e3, 1e3, 1e3, 1e3, 1e3, 1e3, 1e3, 1e3, 1e3, 1e3]]\n";

/// Waits until the child has computed for a while.
fn wait_for_work(child: &mut Child) {
    until_used(child, 0.3);
}

fn press_ctrl_c(child: &Child) {
    send("INT", child);
}

fn send(signal: &str, child: &Child) {
    let kill = Command::new("sh").args(["-c", &format!("kill -{signal} {}", child.id())]).status();
    assert!(kill.expect("sh runs").success());
}

/// Reads until this text has come.
fn wait_for_word(from: &mut impl Read, word: &str) {
    let (mut text, mut byte) = (Vec::new(), [0]);
    while !text.ends_with(word.as_bytes()) {
        from.read_exact(&mut byte).unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&text)));
        text.extend(byte);
    }
}

fn spawn(bench: &Bench, line: &str) -> Child {
    let mut command = bench.command(line);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts")
}

/// Situation: a program that ends with an error at once.
/// Action: wait for its work, as the tests below do.
/// Must hold: the wait fails soon, with the exit code and what the program said.
#[test]
fn a_wait_ends_with_its_program() {
    let mut child = spawn(&Bench::new(PROGRAM), "basin --speeds 4 --bicycle missing");
    let start = Instant::now();
    let waited = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| wait_for_work(&mut child)));
    assert!(start.elapsed() < Duration::from_secs(60), "{:?}", start.elapsed());
    let said = waited.expect_err("no work").downcast::<String>().expect("a text");
    assert!(said.contains("exit status: 1") && said.contains("error: unknown bicycle `missing`"), "{said}");
}

/// Situation: a long basin, some of it done.
/// Action: Ctrl-C.
/// Must hold: exit code 130 soon; all outputs written, completed results preserved, the others null.
#[test]
fn an_interrupted_basin_preserves_completed_speeds() {
    let bench = Bench::new(PROGRAM);
    let mut child =
        spawn(&bench, &format!("{MANY} --json out.json --csv out.csv --svg out.svg --png out.png"));
    wait_for_work(&mut child);
    press_ctrl_c(&child);
    let run = Run::from(child.wait_with_output().unwrap());
    assert_eq!(run.code, Some(130), "{run:?}");
    assert!(run.stderr.contains("of 60001 speeds are done and kept"), "{}", run.stderr);
    assert_eq!(bench.files(), ["out.csv", "out.json", "out.png", "out.svg"]);
    assert!(run.stdout.contains(" of 60001 speeds: no area and no mean height"), "{}", run.stdout);
    assert!(!run.stdout.contains("rad m/s^2"), "{}", run.stdout);
    let document: Value = serde_json::from_str(&bench.read("out.json")).unwrap();
    assert_eq!(document["complete"], false);
    assert!(document["area"].is_null() && document["mean_height"].is_null());
    let upper = document["height"]["upper"].as_array().unwrap();
    let capped = document["capped"].as_array().unwrap();
    let outcomes = document["map"]["outcome"].as_array().unwrap();
    assert_eq!((upper.len(), capped.len(), outcomes.len()), (60001, 60001, 60001));
    let done = upper.iter().filter(|u| u.is_number()).count();
    assert!(done > 0 && done < 60001, "{done}");
    for ((upper, capped), outcome) in upper.iter().zip(capped).zip(outcomes) {
        let missing = upper.is_null();
        assert_eq!((capped.is_null(), outcome.as_array().unwrap().is_empty()), (missing, missing));
    }
    assert_eq!(bench.read("out.csv").matches(",border,").count(), done);
}

/// Situation: a long plane, and a comparison of two long basins; part of each is done.
/// Action: Ctrl-C.
/// Must hold: the text says how much is searched and names the case that was not begun, and states no area, mean or extent of that
/// part.
#[test]
fn an_interrupted_search_states_no_area() {
    let bench = Bench::new(PROGRAM);
    let plane = "basin plane --speed 4 --rays 10000";
    let compare = "basin compare 'a=--time-limit 0.2' 'b=--time-limit 0.2' --speeds 0:30:0.0005 --scan-step 10 \
                   --tolerance 5 --json out.json";
    for (line, said) in [(plane, " of 10000 rays: no area"), (compare, "`a` is incomplete (")] {
        let mut child = spawn(&bench, line);
        wait_for_work(&mut child);
        press_ctrl_c(&child);
        let run = Run::from(child.wait_with_output().unwrap());
        assert_eq!(run.code, Some(130), "{line}: {run:?}");
        assert!(run.stdout.contains(said), "{line}: {}", run.stdout);
        assert!(!run.stdout.contains("reaches"), "{line}: {}", run.stdout);
        let begun = !run.stdout.contains("`b` is missing: none of its speeds is done\n");
        assert_eq!(begun, line == plane, "{line}: {}", run.stdout);
    }
    let document: Value = serde_json::from_str(&bench.read("out.json")).unwrap();
    let case = &document["cases"][0];
    assert_eq!(document["missing"], serde_json::json!(["b"]));
    assert_eq!(case["complete"], false);
    for measure in ["area", "mean_height", "relative_area", "relative_height"] {
        assert!(case[measure].is_null(), "{measure}: {}", case[measure]);
    }
}

/// Situation: a long basin and a sweep of many short cells, some of each done.
/// Action: SIGTERM, as a cluster sends it at a time limit.
/// Must hold: exit code 130, not the signal's; completed results are preserved: speeds of the basin, cells of the
/// sweep.
#[test]
fn a_sigterm_preserves_completed_results() {
    let bench = Bench::new(PROGRAM);
    let units = || std::fs::read_dir(bench.path("s/units")).map_or(0, Iterator::count);
    let sweep = "sweep --over torque-limit=1:40/400 --law h --speeds 5 --threads 1 --out s";
    let basin = format!("{MANY} --csv out.csv");
    for (line, output) in [(&*basin, "speeds are done and kept"), (sweep, "cells are done and kept")] {
        let mut child = spawn(&bench, line);
        wait_for_work(&mut child);
        until_done(&mut child, "a cell", |_| (line != sweep || units() > 0).then_some(()));
        send("TERM", &child);
        let run = Run::from(child.wait_with_output().unwrap());
        assert_eq!(run.code, Some(130), "{line}: {run:?}");
        assert!(run.stderr.contains(output), "{line}: {}", run.stderr);
    }
    assert!(bench.read("out.csv").contains(",border,"));
    assert!((1..400).contains(&units()), "{}", units());
}

/// Situation: a basin with many drawn riders, that of the table done.
/// Action: Ctrl-C.
/// Must hold: exit code 130; the finished draws are kept, and the document, which has fewer than requested, is not complete.
#[test]
fn an_interrupted_band_is_not_complete() {
    let bench = Bench::new(PROGRAM);
    let quick = "--speeds 4:5:1 --time-limit 0.5 --scan-step 10 --tolerance 5";
    let mut child = spawn(
        &bench,
        &format!("basin {quick} --rider young --rider-draws 10000 --json out.json --csv out.csv"),
    );
    // All riders are drawn first, in less than a second of processor time; their basins take half a minute.
    until_used(&mut child, 2.0);
    press_ctrl_c(&child);
    let run = Run::from(child.wait_with_output().unwrap());
    assert_eq!(run.code, Some(130), "{run:?}");
    assert!(run.stderr.contains(" of 10000 draws are done and kept"), "{}", run.stderr);
    let document: Value = serde_json::from_str(&bench.read("out.json")).unwrap();
    assert!(document["rider_draws"]["draws"].as_u64().unwrap_or(0) < 10000, "{}", document["rider_draws"]);
    assert_eq!(document["complete"], false);
    assert!(document["area"].is_number() && bench.read("out.csv").contains("\"complete\":false"));
}

/// Situation: commands that keep nothing, each under way for minutes.
/// Action: Ctrl-C; SIGTERM.
/// Must hold: exit code 130 at once, not the signal's; nothing is written.
#[test]
fn commands_that_keep_nothing_end_at_the_first_signal() {
    let bench = Bench::new(PROGRAM);
    let ride = "ride --speed 6 --steer-rate 0.1 --time-limit 3600 --json new.json";
    let record = "record --rider young --speed 5 --duration 3600 --out new.csv";
    for (line, signal) in [(ride, "INT"), (ride, "TERM"), (record, "INT"), (record, "TERM")] {
        let mut child = spawn(&bench, line);
        wait_for_work(&mut child);
        send(signal, &child);
        let run = Run::from(child.wait_with_output().unwrap());
        assert_eq!((run.code, bench.files()), (Some(130), vec![]), "{line}, {signal}: {run:?}");
    }
}

/// Situation: eigenvalues of a delayed rider; the search for stable speeds, which comes first, takes many seconds.
/// Action: SIGTERM.
/// Must hold: exit code 130 soon, nothing written.
#[test]
fn eigenvalues_end_soon() {
    let bench = Bench::new(PROGRAM);
    bench.write("rider.toml", QUICK_RIDER);
    let mut command = bench.command("eigen --rider rider.toml --speeds 4 --json out.json");
    command.env("RAYON_NUM_THREADS", "1").stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program starts");
    wait_for_work(&mut child);
    let start = Instant::now();
    send("TERM", &child);
    let run = Run::from(child.wait_with_output().unwrap());
    assert_eq!(run.code, Some(130), "{run:?}");
    assert!(start.elapsed() < Duration::from_secs(3), "{:?}", start.elapsed());
    assert_eq!(bench.files(), ["rider.toml"]);
}

/// Situation: the identification of one record, with a delay profile that takes minutes.
/// Action: Ctrl-C.
/// Must hold: exit code 130; it says that nothing is written, and nothing of finished records; no file.
#[test]
fn an_interrupted_identification_says_that_nothing_is_written() {
    let bench = Bench::new(PROGRAM);
    assert_eq!(bench.run("record --rider young --speed 4 --out record.csv").code, Some(0));
    let line = "identify record.csv --delay-profile 0:120:0.2 --out rider.toml --json out.json";
    let mut child = spawn(&bench, line);
    wait_for_work(&mut child);
    press_ctrl_c(&child);
    let run = Run::from(child.wait_with_output().unwrap());
    assert_eq!(run.code, Some(130), "{run:?}");
    assert!(run.stderr.contains("no record is finished, nothing is written"), "{}", run.stderr);
    assert!(!run.stderr.contains("finished ones are written"), "{}", run.stderr);
    assert_eq!(bench.files(), ["record.csv"]);
}

/// Situation: a column that takes minutes, results going to a new and to an older file.
/// Action: Ctrl-C twice.
/// Must hold: exit code 130 at once; the older file unchanged, nothing new.
#[test]
fn a_second_ctrl_c_quits_at_once_without_files() {
    let bench = Bench::new(PROGRAM);
    bench.write("old.json", "older result");
    let mut child = spawn(&bench, &format!("{LONG} --json old.json --csv new.csv"));
    wait_for_work(&mut child);
    let start = Instant::now();
    press_ctrl_c(&child);
    wait_for_word(child.stderr.as_mut().expect("piped"), "again to quit at once");
    press_ctrl_c(&child);
    let run = Run::from(child.wait_with_output().unwrap());
    assert_eq!(run.code, Some(130), "{run:?}");
    // Far less than the column takes.
    assert!(start.elapsed() < Duration::from_secs(30), "{:?}", start.elapsed());
    assert_eq!((bench.files(), bench.read("old.json").as_str()), (vec!["old.json".into()], "older result"));
}

/// Situation: a ride of an hour and a basin of minutes.
/// Action: kill the program.
/// Must hold: no file is left behind.
#[test]
fn a_killed_run_leaves_no_file() {
    let bench = Bench::new(PROGRAM);
    for line in ["ride --speed 6 --time-limit 3600", LONG] {
        let mut child = spawn(&bench, &format!("{line} --json new.json --csv new.csv"));
        wait_for_work(&mut child);
        child.kill().unwrap();
        assert_eq!(child.wait().unwrap().signal(), Some(9), "{line}: over before it was killed");
        assert_eq!(bench.files(), [""; 0], "{line}");
    }
}

/// Situation: a reader of standard output that closes it at once, as `head` does.
/// Action: run each command.
/// Must hold: no panic, exit code 0, and requested files are written nevertheless.
#[test]
fn a_closed_output_is_no_error() {
    let bench = Bench::new(PROGRAM);
    for line in [
        "basin --speeds 4 --max-rate 1 --csv table.csv",
        "basin --speeds 4 --max-rate 1 --csv table.csv --json",
        "ride --speed 4 --csv table.csv --json",
        "eigen --speeds 4 --csv table.csv",
        "bicycle list",
        "bicycle show",
        "bicycle check --json",
        "schema basin",
    ] {
        let _ = std::fs::remove_file(bench.path("table.csv"));
        let mut child = spawn(&bench, line);
        drop(child.stdout.take());
        let run = Run::from(child.wait_with_output().unwrap());
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{line}");
        assert_eq!(bench.path("table.csv").exists(), line.contains("table.csv"), "{line}");
    }
}

/// Situation: standard error is closed.
/// Action: run a command that reports an error.
/// Must hold: exit code 1 as usual, no panic.
#[test]
fn errors_on_a_closed_stream_are_no_panic() {
    let bench = Bench::new(PROGRAM);
    let mut child = spawn(&bench, "eigen --bicycle missing.toml");
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(1));
}
