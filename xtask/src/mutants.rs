//! Runs mutation tests of the control crate with cargo-mutants, configured in `.cargo/mutants.toml`.

use crate::Result;
use crate::paths::root;
use crate::process::{capture, must};
use std::process::Command;
use std::time::Duration;

const MISSING: &str = "cargo-mutants is missing: cargo install cargo-mutants --locked";

/// Parses a number of mutants.
///
/// # Errors
/// The text is no integer from 1 on.
pub fn sample(count: &str) -> Result<usize> {
    let typed = count.parse().ok().filter(|count| *count > 0);
    typed.ok_or_else(|| format!("{count:?} mutants: expected an integer of at least 1"))
}

/// Tests every mutant, or at most `sample` of them, evenly spaced; `arguments` go to cargo-mutants, whose results are
/// in target/mutants.out.
///
/// # Errors
/// cargo-mutants is missing, a mutant survived or timed out, or the tests fail without a mutant.
pub fn mutants(sample: Option<usize>, arguments: &[&str]) -> Result<()> {
    let mut all = cargo_mutants(arguments);
    let outcome = capture(all.arg("--list"), Duration::from_secs(600))?;
    if outcome.status != Some(0) {
        let missing = outcome.stderr.contains("no such command");
        return Err(if missing { MISSING.into() } else { outcome.stderr });
    }
    let found = outcome.stdout.lines().count();
    let mut run = cargo_mutants(arguments);
    if let Some(sample) = sample {
        let shards = found.div_ceil(sample.max(1)).max(1);
        run.args(["--sharding", "round-robin", "--shard", &format!("0/{shards}")]);
    }
    // Shrinking is unnecessary for a mutant that is caught.
    run.args(["--output", "target"]).env("PROPTEST_MAX_SHRINK_ITERS", "0");
    must(&mut run, Duration::from_secs(6 * 3600))
}

fn cargo_mutants(arguments: &[&str]) -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    cargo.current_dir(root()).arg("mutants").args(arguments);
    cargo
}
