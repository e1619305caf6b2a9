//! Runs a program without a time limit and reports periodically what it is doing.

use crate::Result;
use crate::process::{ended, start};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Interval of the reports.
const REPORT_INTERVAL: Duration = Duration::from_secs(300);
/// Interval at which the program's children are listed.
const POLL_INTERVAL: Duration = Duration::from_millis(500);

/// Runs a program that writes to the terminal itself, without a time limit; any failure is an error. Every five
/// minutes, a line on standard error lists its child programs and how long each has been running.
///
/// # Errors
/// It cannot be started, or failed.
pub fn must_whenever(command: &mut Command) -> Result<()> {
    let mut child = start(command.stdin(Stdio::null()))?;
    let (begin, mut reported) = (Instant::now(), Instant::now());
    let mut running: Vec<(String, Instant)> = Vec::new();
    loop {
        match child.try_wait() {
            Ok(None) => sleep(POLL_INTERVAL),
            outcome => return ended(command, outcome.map(|status| status.and_then(|status| status.code()))),
        }
        follow(&mut running, started_by(child.id()));
        if reported.elapsed() >= REPORT_INTERVAL {
            reported = Instant::now();
            eprintln!("xtask: after {}: {}", minutes(begin.elapsed()), described(&running));
        }
    }
}

/// Updates the list of running programs with their start times.
fn follow(running: &mut Vec<(String, Instant)>, now: Vec<String>) {
    running.retain(|(name, _)| now.contains(name));
    for name in now {
        if running.iter().all(|(known, _)| *known != name) {
            running.push((name, Instant::now()));
        }
    }
}

fn described(running: &[(String, Instant)]) -> String {
    let each = running.iter().map(|(name, since)| format!("{name} for {}", minutes(since.elapsed())));
    let each: Vec<String> = each.collect();
    if each.is_empty() { "still running".into() } else { format!("running {}", each.join(", ")) }
}

fn minutes(time: Duration) -> String {
    let seconds = time.as_secs();
    format!("{} min {:02} s", seconds / 60, seconds % 60)
}

/// The command lines of a process's children, from Linux's `/proc`; empty on other systems.
fn started_by(process: u32) -> Vec<String> {
    // A child is listed under the thread that started it.
    let threads = std::fs::read_dir(format!("/proc/{process}/task")).into_iter().flatten().flatten();
    let children = threads.filter_map(|thread| std::fs::read_to_string(thread.path().join("children")).ok());
    let children: String = children.collect();
    let command = |child| std::fs::read(format!("/proc/{child}/cmdline")).unwrap_or_default();
    // A child that is just starting has no name yet.
    let names = children.split_whitespace().map(|child| named(&command(child)));
    names.filter(|name| !name.is_empty()).collect()
}

/// A program's name, with the crate if it is the compiler.
fn named(command: &[u8]) -> String {
    let arguments: Vec<_> = command.split(|byte| *byte == 0).map(String::from_utf8_lossy).collect();
    let program = arguments.first().map_or("", |argument| argument.rsplit('/').next().unwrap_or_default());
    let crate_name =
        arguments.iter().position(|argument| argument == "--crate-name").and_then(|at| arguments.get(at + 1));
    crate_name.map_or_else(|| program.into(), |name| format!("{program} {name}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Situation: this program starts another. Action: list its children. Must hold: the other is named without its
    /// path; it is removed from the list when it ends, and running ones keep their start times.
    #[test]
    fn programs_are_named_while_they_run() {
        let mut child = Command::new("sleep").arg("60").spawn().unwrap();
        let mut running = Vec::new();
        for _ in 0..1000 {
            follow(&mut running, started_by(std::process::id()));
            if !running.is_empty() {
                break;
            }
            sleep(Duration::from_millis(10));
        }
        let known = cfg!(target_os = "linux");
        assert_eq!(described(&running).contains("sleep for 0 min 0"), known, "{running:?}");
        child.kill().unwrap();
        child.wait().unwrap();
        follow(&mut running, started_by(std::process::id()));
        assert!(!described(&running).contains("sleep"), "{running:?}");
        assert_eq!(named(b"/a/b/rustc\0--crate-name\0sil\0"), "rustc sil");
        assert_eq!(minutes(Duration::from_secs(3725)), "62 min 05 s");
    }
}
