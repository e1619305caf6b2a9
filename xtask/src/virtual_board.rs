//! Builds, runs and tests the package `virtual-board`, which is no default member because of the emulated core's
//! dependencies.

use crate::process::must;
use crate::{Result, image, paths, progress};
use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

/// Target directory of the program, the same with any `CARGO_TARGET_DIR`: `sim-host` starts the program from there.
fn target_dir() -> PathBuf {
    paths::root().join("target")
}

/// Path of the built program.
pub fn program() -> PathBuf {
    target_dir().join("virtual-board/virtual-board")
}

/// Builds the program and the images it runs.
///
/// # Errors
/// Cargo failed.
pub fn build() -> Result<()> {
    image::build("board-vesc6")?;
    progress::must_whenever(&mut cargo_build())
}

/// The command that builds [`program`].
pub fn cargo_build() -> Command {
    let mut cargo = cargo("build");
    cargo.args(["--bin", "virtual-board", "--profile", "virtual-board", "--target-dir"]).arg(target_dir());
    cargo
}

/// Runs the built program with these arguments until it ends.
///
/// # Errors
/// It cannot be started, or failed.
pub fn run(arguments: &[&str]) -> Result<()> {
    must(Command::new(program()).args(arguments), Duration::MAX)
}

/// Runs its tests; the images must be built.
///
/// # Errors
/// Cargo or a test failed.
pub fn test(arguments: &[&str]) -> Result<()> {
    let mut cargo = cargo("test");
    progress::must_whenever(cargo.args(arguments).env("STEER_ASSIST_REQUIRE_QEMU", "1"))
}

fn cargo(command: &str) -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    cargo.current_dir(paths::root()).arg(command);
    // The emulated core declares a newer Rust version than it needs.
    cargo.args(["--package", "virtual-board", "--ignore-rust-version"]);
    cargo
}
