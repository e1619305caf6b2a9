//! `tests/python/test_fmi.py`, in an environment with FMPy.

use std::process::Command;
use tests::cli::{Run, repository};
use tests::python;

/// Situation: FMUs as a user exports them. Action: FMPy validates, couples, saves and restores them. Must hold: what
/// `test_fmi.py` says of each. Skipped, with a word, without Python or its packages.
#[test]
fn fmus_in_fmpy() {
    let Some(python) = python::venv("fmi") else { return };
    let mut pytest = Command::new(python);
    pytest
        .args(["-m", "pytest", "-q", "-rA", "-p", "no:cacheprovider", "test_fmi.py"])
        .current_dir(repository("tests/python"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("SIM_HOST", env!("CARGO_BIN_EXE_sim-host-under-test"));
    let ran: Run = pytest.output().expect("Python runs").into();
    assert_eq!(ran.code, Some(0), "{}{}", ran.stdout, ran.stderr);
    println!("{}", ran.stdout);
}
