//! Mutation tests of the control crate by cargo-mutants, as `.cargo/mutants.toml` says.

use crate::Result;
use crate::image::root;
use crate::process::{capture, must};
use std::process::Command;
use std::time::Duration;

const MISSING: &str = "cargo-mutants is missing: cargo install cargo-mutants --locked";

/// A number of mutants as typed.
///
/// # Errors
/// It is no count from 1 on.
pub fn sample(count: &str) -> Result<usize> {
    let typed = count.parse().ok().filter(|count| *count > 0);
    typed.ok_or_else(|| format!("{count:?} mutants: a count from 1 on is wanted"))
}

/// Tests every mutant, or at most `sample` of them, evenly picked; `arguments` go to cargo-mutants.
/// What it found is kept in target/mutants.out.
///
/// # Errors
/// cargo-mutants is missing, or a mutant survived, did not end in time, or the cards fail without one.
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
    // A mutant that is caught is not looked at any closer.
    run.args(["--output", "target"]).env("PROPTEST_MAX_SHRINK_ITERS", "0");
    must(&mut run, Duration::from_secs(6 * 3600))
}

fn cargo_mutants(arguments: &[&str]) -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    cargo.current_dir(root()).arg("mutants").args(arguments);
    cargo
}
