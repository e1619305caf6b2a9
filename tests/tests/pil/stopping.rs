//! The emulators when the program stops.
#![cfg(target_os = "linux")]

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use tests::cli::{Bench, Run, word};
use tests::wait::{until, until_done, used_s};
use xtask::image;

const PROGRAM: &str = env!("CARGO_BIN_EXE_sim-host-under-test");

fn spawn(bench: &Bench, line: &str) -> Child {
    let line = format!("{line} --image {}", word(&image::path("qemu-pil")));
    let mut command = bench.command(&line);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts")
}

/// The emulator that a program started, once it has computed for a while.
fn emulator(child: &mut Child) -> PathBuf {
    let tasks = PathBuf::from(format!("/proc/{}/task", child.id()));
    until_done(child, "an emulator at work", |_| {
        let threads = std::fs::read_dir(&tasks).ok()?.flatten();
        let children =
            threads.filter_map(|thread| std::fs::read_to_string(thread.path().join("children")).ok());
        let one = children.flat_map(|ids| ids.split_whitespace().next().map(str::to_owned)).next()?;
        (used_s(one.parse().ok()?)? >= 1.0).then(|| Path::new("/proc").join(one))
    })
}

fn signal(name: &str, child: &Child) {
    let kill = Command::new("sh").args(["-c", &format!("kill -{name} {}", child.id())]).status();
    assert!(kill.expect("sh runs").success());
}

/// Situation: a basin of many short columns on the chip, some of it done.
/// Action: Ctrl-C.
/// Must hold: exit code 130; completed results are written, the rest is null; the emulator has ended.
#[test]
fn an_interrupted_basin_on_the_chip_preserves_completed_speeds() {
    if !image::ready() {
        return;
    }
    let bench = Bench::new(PROGRAM);
    let many = "pil basin --speeds 3:9:0.001 --time-limit 0.05 --scan-step 10 --max-rate 10 --tolerance 10";
    let mut child = spawn(&bench, &format!("{many} --threads 1 --json out.json"));
    let emulator = emulator(&mut child);
    signal("INT", &child);
    let run = Run::from(child.wait_with_output().unwrap());
    assert_eq!(run.code, Some(130), "{run:?}");
    assert!(run.stderr.contains("of 6001 speeds are done and kept"), "{}", run.stderr);
    let document: Value = serde_json::from_str(&bench.read("out.json")).unwrap();
    let upper = document["height"]["upper"].as_array().unwrap();
    let done = upper.iter().filter(|u| u.is_number()).count();
    assert!(done > 0 && done < 6001, "{done}");
    assert!(!emulator.exists());
}

/// Situation: a ride on the chip.
/// Action: the program is killed, and cannot end its emulator.
/// Must hold: the emulator ends by itself.
#[test]
fn an_emulator_ends_with_its_program() {
    if !image::ready() {
        return;
    }
    let mut child = spawn(&Bench::new(PROGRAM), "pil --speed 4 --time-limit 3600");
    let emulator = emulator(&mut child);
    signal("KILL", &child);
    child.wait().unwrap();
    until("the emulator's end", || (!emulator.exists()).then_some(()));
}
