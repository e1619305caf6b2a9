//! Compares the computing time of the simulator with that of an earlier commit: builds both, runs the same commands in
//! turn, and prints medians and their ratios.

use crate::paths::root;
use crate::process::{capture, must};
use crate::{Result, process};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

const GIT: Duration = Duration::from_secs(120);
const BUILD: Duration = Duration::from_secs(3600);
const RUN: Duration = Duration::from_secs(3600);

/// What is timed: a name, and the arguments of `sim-host` that every commit knows.
const WORK: [(&str, &[&str]); 11] = [
    ("h basin, control crate at 1 kHz", &["basin"]),
    ("h basin, ideal law", &["basin", "--assist", "ideal"]),
    ("basin without assist", &["basin", "--law", "none"]),
    ("young rider's basin", &["basin", "--rider", "young"]),
    (
        "product with the smart rider, one speed in five",
        &["basin", "--preset", "product", "--rider", "smart", "--speeds", "2:7.5:0.5"],
    ),
    ("product, one speed in ten", &["basin", "--preset", "product", "--speeds", "0:10:1"]),
    ("plane at 4 m/s", &["basin", "plane", "--speed", "4"]),
    (
        "one ride of 300 s with the young rider",
        &[
            "ride",
            "--speed",
            "4",
            "--steer-rate",
            "1",
            "--rider",
            "young",
            "--law",
            "none",
            "--time-limit",
            "300",
        ],
    ),
    ("eigenvalues of the young rider", &["eigen", "--rider", "young"]),
    ("study limits", &["study", "limits"]),
    ("thesis --quick", &["thesis", "--quick"]),
];

/// Builds `commit` beside the work tree, runs each command `runs` times with either program, and prints a table.
///
/// # Errors
/// The commit is not in the repository, a build fails, or a command fails.
pub fn against(commit: &str, runs: usize) -> Result<()> {
    let before = built(&checked_out(commit)?)?;
    let now = built(root())?;
    let place = std::env::temp_dir().join(format!("steer-assist-against-{}", std::process::id()));
    std::fs::create_dir_all(&place).map_err(|e| format!("{}: {e}", place.display()))?;
    let table = table(commit, &[before, now], runs, &place);
    // Removed whatever the outcome.
    let _ = std::fs::remove_dir_all(&place);
    print!("{}", table?);
    Ok(())
}

/// A work tree of the commit, below `target`.
fn checked_out(commit: &str) -> Result<PathBuf> {
    let mut name = Command::new("git");
    name.current_dir(root()).args(["rev-parse", "--verify", "--quiet", &format!("{commit}^{{commit}}")]);
    let found = capture(&mut name, GIT)?;
    if found.status != Some(0) {
        return Err(format!("no commit {commit:?} in this repository"));
    }
    let hash = found.stdout.trim().to_owned();
    let place = root().join("target/against").join(hash.get(..12).unwrap_or(&hash));
    if !place.join("Cargo.toml").exists() {
        let mut add = Command::new("git");
        add.current_dir(root()).args(["worktree", "add", "--force", "--detach", "--quiet"]);
        must(add.arg(&place).arg(&hash), GIT)?;
    }
    Ok(place)
}

/// Builds the simulator in a work tree.
fn built(tree: &Path) -> Result<PathBuf> {
    let target = tree.join("target");
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    cargo.current_dir(tree).args(["build", "--release", "--quiet", "--package", "sim-host", "--target-dir"]);
    must(cargo.arg(&target), BUILD)?;
    Ok(target.join("release/sim-host"))
}

fn table(commit: &str, programs: &[PathBuf; 2], runs: usize, place: &Path) -> Result<String> {
    let mut table = format!(
        "| work, one thread, median of {runs} | {commit} \\[s\\] | now \\[s\\] | ratio |\n| --- | ---: | ---: | ---: |\n"
    );
    for (name, arguments) in WORK {
        let mut seconds = [Vec::new(), Vec::new()];
        for _ in 0..runs {
            for (program, seconds) in programs.iter().zip(&mut seconds) {
                seconds.push(timed(program, arguments, place)?);
            }
        }
        let [before, now] = seconds.map(median);
        let _ = writeln!(table, "| {name} | {before:.2} | {now:.2} | 1/{:.1} |", before / now);
        eprintln!("{name}: {before:.2} s, {now:.2} s");
    }
    Ok(table)
}

/// Processor time of a run \[s\], or its duration where the system does not report the former.
fn timed(program: &Path, arguments: &[&str], place: &Path) -> Result<f64> {
    let (before, begun) = (process::processor_s(), Instant::now());
    // A study continues what an earlier run left in its folder: each run has its own.
    let folder = place.join("run");
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut command = Command::new(program);
    command.current_dir(&folder).args(arguments).env("RAYON_NUM_THREADS", "1");
    let outcome = capture(&mut command, RUN);
    std::fs::remove_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let outcome = outcome?;
    if outcome.status != Some(0) {
        return Err(format!("{command:?} failed\n{}", outcome.stderr));
    }
    let elapsed_s = begun.elapsed().as_secs_f64();
    Ok(before.zip(process::processor_s()).map_or(elapsed_s, |(before, after)| after - before))
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
