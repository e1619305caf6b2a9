//! `sim-host` as a library of another program.

use std::process::Command;
use tests::cli::repository;

/// Crates of the terminal and the command line.
const TERMINAL: [&str; 6] = ["clap", "console", "indicatif", "shlex", "signal-hook", "terminal_size"];

/// Names of the crates that `sim-host` needs, with these arguments of `cargo tree`.
fn dependencies(arguments: &[&str]) -> Vec<String> {
    let cargo = std::env::var_os("CARGO").unwrap_or("cargo".into());
    let mut command = Command::new(cargo);
    command.current_dir(repository("")).args(["tree", "--offline", "--locked", "--package", "sim-host"]);
    let listed =
        command.args(["--edges", "normal", "--prefix", "none"]).args(arguments).output().expect("cargo runs");
    assert!(listed.status.success(), "{}", String::from_utf8_lossy(&listed.stderr));
    let text = String::from_utf8(listed.stdout).expect("text");
    text.lines().filter_map(|line| line.split(' ').next()).map(str::to_owned).collect()
}

/// Situation: another program uses the library without its default features. Action: list the crates that it then needs, and those
/// of the program. Must hold: no crate of the terminal or the command line in the first list, each in the second; `physics` and `analysis` in
/// both.
#[test]
fn the_library_needs_no_terminal() {
    let (library, program) = (dependencies(&["--no-default-features"]), dependencies(&[]));
    let has = |list: &[String], name: &str| list.iter().any(|listed| listed == name);
    for name in TERMINAL {
        assert!(!has(&library, name), "{name} is needed by the library");
        assert!(has(&program, name), "{name} is not needed by the program either");
    }
    for name in ["physics", "analysis"] {
        assert!(has(&library, name) && has(&program, name), "{name}");
    }
    assert!(library.len() < program.len());
}
