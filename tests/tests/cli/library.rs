//! `sim-host` as a library of another program.

use std::process::Command;
use tests::cli::repository;

/// Crates of the terminal and the command line.
const TERMINAL: [&str; 6] = ["clap", "console", "indicatif", "shlex", "signal-hook", "terminal_size"];

/// Parts whose arithmetic is selected by the processor at run time, in the words of `cargo tree`.
const BY_PROCESSOR: [&str; 3] = ["matrixmultiply v", "rustfft feature \"avx\"", "rustfft feature \"sse\""];

/// The dependencies of a package, as `cargo tree` lists them with these arguments.
fn tree(package: &str, arguments: &[&str]) -> String {
    let cargo = std::env::var_os("CARGO").unwrap_or("cargo".into());
    let mut command = Command::new(cargo);
    command.current_dir(repository("")).args(["tree", "--offline", "--locked", "--prefix", "none"]);
    let listed = command.args(["--package", package]).args(arguments).output().expect("cargo runs");
    assert!(listed.status.success(), "{}", String::from_utf8_lossy(&listed.stderr));
    String::from_utf8(listed.stdout).expect("text")
}

/// Names of the crates that `sim-host` needs, with these arguments of `cargo tree`.
fn dependencies(arguments: &[&str]) -> Vec<String> {
    let listed = tree("sim-host", &[&["--edges", "normal"], arguments].concat());
    listed.lines().filter_map(|line| line.split(' ').next()).map(str::to_owned).collect()
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

/// Situation: results have the same bytes on every processor. Action: list what the program with everything and these tests are
/// compiled from. Must hold: nalgebra and the Fourier transform are there, without their parts that select instructions at run time.
#[test]
fn no_arithmetic_depends_on_the_processor() {
    for (package, arguments) in [("sim-host", ["--features", "full"]), ("tests", ["--features", ""])] {
        let listed = tree(package, &[&["--edges", "normal,dev,features"], &arguments[..]].concat());
        assert!(listed.contains("nalgebra v") && listed.contains("rustfft v"), "{listed}");
        for part in BY_PROCESSOR {
            assert!(!listed.contains(part), "{package} needs {part}");
        }
    }
}
