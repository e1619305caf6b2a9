//! Python programs as independent witnesses, each in a virtual environment of its own.
//!
//! `tests/python/NAME.txt` lists the packages of the environment NAME; it is made at the first use, in
//! `target/python/NAME`, and again whenever the list changes. The programs are in `tests/python`, too.

use crate::cli::{Run, repository};
use std::ffi::OsStr;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The interpreter of an environment, with the packages of `tests/python/NAME.txt` installed.
///
/// `None`, with a line on standard error, without Python 3.11, or if the packages cannot be downloaded. Tests that run at
/// the same time share the environment.
///
/// # Panics
/// If the list is missing or names a package that cannot be installed, or the target folder cannot be written to.
pub fn venv(name: &str) -> Option<PathBuf> {
    let list = repository("tests/python").join(format!("{name}.txt"));
    let packages = fs::read_to_string(&list).unwrap_or_else(|e| panic!("{}: {e}", list.display()));
    let all = repository("target/python");
    fs::create_dir_all(&all).unwrap_or_else(|e| panic!("{}: {e}", all.display()));
    let lock = File::create(all.join(format!("{name}.lock"))).expect("the folder can be written to");
    lock.lock().expect("a lock");
    let (folder, stamp) = (all.join(name), all.join(name).join("installed.txt"));
    let python = folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    if fs::read_to_string(&stamp).is_ok_and(|installed| installed == packages) {
        return Some(python);
    }
    match installed(&folder, &python, &list) {
        Ok(()) => {
            fs::write(&stamp, packages).expect("the folder can be written to");
            Some(python)
        }
        Err(reason) => {
            eprintln!("skipped: no Python environment with the packages of {}: {reason}", list.display());
            None
        }
    }
}

/// Makes the environment; the error is why a machine cannot have it.
fn installed(folder: &Path, python: &Path, list: &Path) -> Result<(), String> {
    let made =
        Command::new("python3").args(["-m", "venv", "--clear"]).arg(folder).stdin(Stdio::null()).output();
    let made: Run = made.map_err(|error| format!("python3: {error}"))?.into();
    if made.code != Some(0) {
        return Err(format!(
            "python3 -m venv failed (Debian: apt-get install python3-venv): {}",
            made.stderr
        ));
    }
    let enough = "import sys; sys.exit(sys.version_info < (3, 11))";
    if run(python, ["-c", enough]).code != Some(0) {
        return Err("needs Python 3.11 or later".to_owned());
    }
    let pip =
        ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--requirement"].map(OsStr::new);
    let pip = run(python, pip.into_iter().chain([list.as_os_str()]));
    match pip.code {
        Some(0) => Ok(()),
        _ if unreachable(&pip.stderr) => {
            Err(format!("PyPI cannot be reached: {}", pip.stderr.lines().next().unwrap_or_default()))
        }
        _ => panic!("{}: {}", list.display(), pip.stderr),
    }
}

/// Whether pip failed because of its network, by its messages: its exit code is that of a package that does not exist.
pub fn unreachable(stderr: &str) -> bool {
    ["connection", "Connection", "timed out", "resolution"].iter().any(|word| stderr.contains(word))
}

/// Runs an interpreter of [`venv`] with these arguments.
///
/// # Panics
/// If it cannot be started.
pub fn run<S: AsRef<OsStr>>(python: &Path, arguments: impl IntoIterator<Item = S>) -> Run {
    let output = Command::new(python).args(arguments).stdin(Stdio::null()).output();
    output.unwrap_or_else(|e| panic!("{}: {e}", python.display())).into()
}

/// Runs the program `tests/python/SCRIPT`, which must succeed; its standard output.
///
/// # Panics
/// With its output, if it fails.
pub fn checked(python: &Path, script: &str, arguments: &[&OsStr]) -> String {
    let script = repository("tests/python").join(script);
    let done = run(python, [&[script.as_os_str()], arguments].concat());
    assert_eq!(done.code, Some(0), "{}:\n{}{}", script.display(), done.stdout, done.stderr);
    done.stdout
}
