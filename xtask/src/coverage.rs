//! Measures line coverage of the control crate's torque path by that crate's tests.

use crate::Result;
use crate::paths::root;
use crate::process::{Outcome, capture, must};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// The files of `control/src` that must be covered completely.
const FILES: [&str; 7] = [
    "safety/engagement.rs",
    "safety/guard.rs",
    "safety/limiter.rs",
    "sensors/measurements.rs",
    "sensors/monitor.rs",
    "sensors/recent.rs",
    "sensors/validation.rs",
];

const BUILD: Duration = Duration::from_secs(4 * 3600);
const TOOL: Duration = Duration::from_secs(600);

/// Runs the tests of the control crate and prints, per file, the number of covered lines and each uncovered one.
///
/// # Errors
/// LLVM's tools are missing, a test fails, or a line is uncovered.
pub fn coverage() -> Result<()> {
    let [profdata, cov] = tools()?;
    let folder = root().join("target/coverage");
    let profiles = folder.join("profiles");
    // Removes the profiles of an earlier run, if any.
    let _ = std::fs::remove_dir_all(&profiles);
    let cards = |arguments: &[&str]| {
        let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
        cargo.current_dir(root()).args(["test", "--package", "control", "--test", "cards"]).args(arguments);
        cargo.env("RUSTFLAGS", "-C instrument-coverage").env("CARGO_TARGET_DIR", &folder);
        cargo.env("LLVM_PROFILE_FILE", profiles.join("%p-%m.profraw"));
        cargo
    };
    must(&mut cards(&[]), BUILD)?;
    let built = capture(&mut cards(&["--no-run", "--message-format", "json"]), BUILD)?;
    let program = built.stdout.split_once(r#""executable":""#).and_then(|(_, rest)| rest.split_once('"'));
    let (program, _) = program.ok_or_else(|| format!("cargo names no test program:\n{}", built.stderr))?;
    let data = folder.join("cards.profdata");
    succeeded(capture(
        Command::new(&profdata).args(["merge", "-sparse"]).arg(&profiles).arg("-o").arg(&data),
        TOOL,
    )?)?;
    let mut export = Command::new(&cov);
    export.args(["export", "--format=lcov", program, "--instr-profile"]).arg(&data);
    report(&succeeded(capture(&mut export, TOOL)?)?)
}

/// Prints the uncovered lines, from lcov's `SF:file` and `DA:line,count`.
fn report(lcov: &str) -> Result<()> {
    let source = root().join("control/src");
    let mut missed = 0;
    for name in FILES {
        let path = source.join(name);
        let here = |line: &&str| line.strip_prefix("SF:").is_some_and(|file| Path::new(file) == path);
        let counts = lcov.lines().skip_while(|line| !here(line)).take_while(|line| *line != "end_of_record");
        let counts: Vec<(usize, &str)> = counts
            .filter_map(|line| line.strip_prefix("DA:")?.split_once(','))
            .filter_map(|(line, count)| Some((line.parse().ok()?, count)))
            .collect();
        if counts.is_empty() {
            return Err(format!("{}: missing in LLVM's coverage", path.display()));
        }
        let text = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        let never: Vec<usize> =
            counts.iter().filter(|(_, count)| *count == "0").map(|(line, _)| *line).collect();
        println!("control/src/{name}: {} of {} lines run", counts.len() - never.len(), counts.len());
        for line in &never {
            println!("  {line}: {}", text.lines().nth(line - 1).unwrap_or_default().trim());
        }
        missed += never.len();
    }
    if missed == 0 { Ok(()) } else { Err(format!("no test runs {missed} lines")) }
}

fn succeeded(outcome: Outcome) -> Result<String> {
    if outcome.status == Some(0) { Ok(outcome.stdout) } else { Err(outcome.stderr) }
}

/// `llvm-profdata` and `llvm-cov` matching the compiler's LLVM: rustup's, or the system's by version.
fn tools() -> Result<[PathBuf; 2]> {
    let rustc = |arguments: &[&str]| {
        let mut rustc = Command::new(std::env::var_os("RUSTC").unwrap_or("rustc".into()));
        capture(rustc.args(arguments), TOOL).map(|outcome| outcome.stdout)
    };
    let about = rustc(&["-vV"])?;
    let field = |name| about.lines().find_map(|line| line.strip_prefix(name)).unwrap_or_default();
    let (host, llvm) = (field("host: "), field("LLVM version: "));
    let number = llvm.split('.').next().unwrap_or_default();
    let rustup = Path::new(rustc(&["--print", "sysroot"])?.trim()).join("lib/rustlib").join(host).join("bin");
    let find = |name: &str| {
        let found = [rustup.join(name), format!("{name}-{number}").into()]
            .into_iter()
            .find(|tool| capture(Command::new(tool).arg("--version"), TOOL).is_ok());
        found.ok_or_else(|| {
            format!(
                "{name} of LLVM {number} is missing: rustup component add llvm-tools, or install your \
                 system's package (Debian: apt-get install llvm-{number})"
            )
        })
    };
    Ok([find("llvm-profdata")?, find("llvm-cov")?])
}
