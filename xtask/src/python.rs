//! The tests of the Python package, in a virtual environment of their own.

use crate::Result;
use crate::paths::root;
use crate::process::{capture, must};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

const LIMIT: Duration = Duration::from_secs(1800);

/// A virtual environment with what builds the package, made at the first call; `None`, with a line on standard error,
/// without Python 3.11 or PyPI.
pub fn environment() -> Option<PathBuf> {
    let place = root().join("target/python/steer_assist");
    let python = place.join("bin/python");
    let made = ran(Command::new("python3").args(["-m", "venv"]).arg(&place))
        .map_err(|e| {
            format!("{e}\nneeded: Python 3.11 or later with venv (Debian: apt-get install python3-venv)")
        })
        .and_then(|()| ran(pip(&python).arg("maturin>=1.9.4,<2")).map_err(|e| format!("{e}\nneeded: PyPI")));
    match made {
        Ok(()) => Some(python),
        Err(error) => {
            eprintln!("skipped: the tests of the Python package: {error}");
            None
        }
    }
}

/// Installs the package with what its tests need, and runs them. `cargo test` has built the command line that its numbers are
/// compared with.
///
/// # Errors
/// The package can't be built, a package is missing, or a test fails.
pub fn test(python: &Path) -> Result<()> {
    let mut install = pip(python);
    // maturin starts its program of the same name by the path.
    let programs = python.parent().unwrap_or(Path::new("")).to_path_buf();
    let others = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths(std::iter::once(programs).chain(std::env::split_paths(&others)))
        .map_err(|e| format!("PATH: {e}"))?;
    // The profile of `cargo test`: most crates are compiled there already.
    install.env("PATH", path).env("MATURIN_PEP517_ARGS", "--profile=dev");
    install.arg("--no-build-isolation").arg("./python[test]");
    must(&mut install, LIMIT)
        .map_err(|e| format!("{e}\nneeded: packages from PyPI (python/pyproject.toml)"))?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    let sim_host = root().join(target).join("debug/sim-host-under-test");
    let mut pytest = Command::new(python);
    pytest.args(["-m", "pytest", "python"]).current_dir(root()).env("STEER_ASSIST_SIM_HOST", sim_host);
    must(&mut pytest, LIMIT)
}

fn pip(python: &Path) -> Command {
    let mut pip = Command::new(python);
    pip.current_dir(root()).args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
    pip
}

/// Runs a program that is to succeed, silently.
fn ran(command: &mut Command) -> Result<()> {
    let done = capture(command, LIMIT)?;
    if done.status == Some(0) { Ok(()) } else { Err(format!("{command:?} failed: {}", done.stderr.trim())) }
}
