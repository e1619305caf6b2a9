//! `cargo xtask`: development commands of the workspace.

use std::process::{Command, ExitCode};
use std::time::Duration;
use xtask::against::against;
use xtask::architecture::architecture;
use xtask::bench::bench;
use xtask::cost::cost;
use xtask::counts::counts;
use xtask::dbc::dbc;
use xtask::document::{self, instruction_table, size_table};
use xtask::reproducible::reproducible;
use xtask::setup::{TargetSource, setup};
use xtask::{Result, coverage, image, instructions, mutants, paths, progress, python, qemu, virtual_board};

const HELP: &str = "\
cargo xtask <command> [--help]

  setup         install what the firmware needs: the chip's target, QEMU, binutils
  test          set-up, build the firmware, run all tests, those in QEMU included
  firmware      build all firmware images
  qemu IMAGE    run an image in QEMU
  virtual-board the board's image on a virtual VESC 6, with its log and its serial line
  flash IMAGE   build a board's image, flash it and show its log
  reproducible  check that clones in different folders build identical images
  size          flash and RAM used by the images, against their budgets
  instructions  instructions of a control step, against the budget
  counts        instructions of rides and basins on the host, against the recorded ones
  dbc           the database of the board's CAN frames, data/can/assist.dbc
  architecture  figure and tables of docs/architecture.md, and the check of the dependencies
  mutants       mutation tests of the control crate
  coverage      lines of the control crate's torque path that its tests do not cover
  bench         computing time beside this machine's peak, and beside Python programs for the same ride
  cost          computing time over the number of rides, speeds and threads
  against       computing time of basins and rides, beside an earlier commit
";

const SETUP_HELP: &str = "\
cargo xtask setup [--target-source auto|rustup|debian]

Installs the Rust target thumbv7em-none-eabihf and, as root, QEMU, binutils and valgrind from apt.
Installed parts are left unchanged. If something cannot be installed, it says what and how to get it;
without valgrind only the instructions on the host are not counted.

  auto    rustup; if its servers can't be reached, Debian (default)
  rustup  rustup target add
  debian  compile core and alloc from Debian's rust-src of the compiler's release: about a minute
";

const TEST_HELP: &str = "\
cargo xtask test [--target-source auto|rustup|debian] [--all] [--mutants N] [-- ARGUMENTS OF cargo test]

Runs the set-up, builds the firmware images, then `cargo test` with the tests in QEMU required: a
missing QEMU or target is a failure, not a skip. Then installs the Python package in target/python, with
packages from PyPI, and runs its tests; not without these, nor if the arguments choose packages of cargo. There is no time limit; every five minutes a line
lists the running programs.

  --all        also run the slow tests, and the full sets of tests that run a part by default
               (STEER_ASSIST_SLOW=1); see docs/testing.md
  --mutants N  then run `cargo xtask mutants --sample N`
";

const FIRMWARE_HELP: &str = "\
cargo xtask firmware

Builds all images of all boards into target/firmware/thumbv7em-none-eabihf/firmware.
";

const QEMU_HELP: &str = "\
cargo xtask qemu IMAGE [NAME=VALUE...]

Builds and runs a QEMU image in simulated time, in the current directory, for at most two minutes;
the exit status is the image's. Try: cargo xtask qemu qemu-control seconds=5 block_us=1500
";

const VIRTUAL_BOARD_HELP: &str = "\
cargo xtask virtual-board [--build | --test [ARGUMENTS OF cargo test] | ARGUMENTS OF virtual-board]

Builds the board's images and the virtual board (three minutes of processor time the first time), then
runs it: it prints the flashed image's log, and the name of the pseudo terminal that is the serial
line. `cargo xtask virtual-board -- --help` lists its own options.

  --build  only build, for `sim-host monitor --virtual-board`
  --test   run its tests instead

Try: cargo xtask virtual-board --seconds 3, or with --align --switch --seconds 7
";

const FLASH_HELP: &str = "\
cargo xtask flash IMAGE

Builds a board's image, as `cargo xtask firmware` does, and hands it to the runner of
.cargo/config.toml: probe-rs, which flashes it and shows its log until Ctrl-C. IMAGE is one of
docs/firmware.md that is not for QEMU.
";

const REPRODUCIBLE_HELP: &str = "\
cargo xtask reproducible

Clones the commit of the work tree into three folders of different length, each with its own commit
and CARGO_HOME, builds all images in each and compares the flashed bytes without the commit's hash.
Fails if they differ. About four minutes of processor time.
";

const SIZE_HELP: &str = "\
cargo xtask size

Prints text, data, bss, flash and RAM of each image and updates docs/images.md. Fails if an
image is over its budget.
";

const INSTRUCTIONS_HELP: &str = "\
cargo xtask instructions

Counts the instructions and the stack of every control step: over the border ride for each law and
configuration, over a ride with every sensor, and with each sensor broken in it. Prints them and
updates docs/images.md. Fails if a step is over its budget, or less than a tenth under it; both are in
that page. Also prints the instructions of single functions, for the table of docs/motor.md.
";

const COUNTS_HELP: &str = "\
cargo xtask counts [--update]

Builds a small program in the release profile and counts, by valgrind's callgrind, the instructions of
a right-hand side, a step of eight rides, control steps, one ride and a small basin. Prints them beside
those of tests/data/instructions.toml and fails if one differs by more than 3 %, up or down (15 % with
another compiler). Needs Linux, a processor with AVX2, and valgrind.

  --update  write the counts into that file instead
";

const BENCH_HELP: &str = "\
cargo xtask bench

Times a ride of 6 s with a rider 30 ms late, in sim-host and in Python with numba and with scipy, and
the rider's basin in sim-host, one after the other; prints one table. Before that it measures the
peak rate of a core and prints what part of it right-hand sides and a small basin reach. Fails if the final states
differ by more than 1e-6, or if the Python programs are unavailable; the rest is printed nevertheless.
Needs Python 3.11 or later for a virtual environment in target/bench-python, with packages from PyPI.
";

const COST_HELP: &str = "\
cargo xtask cost

Times 1 to 64 rides of 6 s, and the h basin at 2 to 101 speeds on one and on two threads. Draws
docs/img/cost.svg and writes the tables of docs/performance.md. Name the machine there. About a minute.
";

const AGAINST_HELP: &str = "\
cargo xtask against COMMIT [--runs N]

Checks out COMMIT below target/against, builds sim-host there and here, runs the same basins and rides
in turn on one thread, N times each (default 3), and prints the medians of the processor time and
their ratios as a table. Several minutes. Remove the work tree with `git worktree remove --force`.

Try: cargo xtask against HEAD~20 --runs 5
";

const DBC_HELP: &str = "\
cargo xtask dbc

Writes data/can/assist.dbc from the tables that the encoder of the board's CAN frames uses.
";

const ARCHITECTURE_HELP: &str = "\
cargo xtask architecture

Compares the dependencies of the crates, and of the top modules of sim-host and control, with
docs/architecture.toml; prints each difference with file and line, and fails if there is one.
Otherwise it writes docs/img/architecture.svg and the tables of docs/architecture.md.
";

const MUTANTS_HELP: &str = "\
cargo xtask mutants [--sample N] [-- ARGUMENTS OF cargo mutants]

Makes small changes to the control crate's torque path, one at a time, and runs its tests: each change
must make one fail. Changes and exclusions, with reasons, are in .cargo/mutants.toml; results are in
target/mutants.out. Fails if a mutant survives. Needs
cargo-mutants (cargo install cargo-mutants --locked).

  --sample N    test at most N mutants, evenly spaced
";

const COVERAGE_HELP: &str = "\
cargo xtask coverage

Runs the control crate's tests and prints the uncovered lines of its torque path. Fails if there are
any. Needs llvm-profdata and llvm-cov of the compiler's LLVM: rustup's component
llvm-tools, or Debian's package llvm-NN.
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match dispatch(&words) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("xtask: {error}");
            ExitCode::FAILURE
        }
    }
}

fn dispatch(words: &[&str]) -> Result<ExitCode> {
    let (command, rest) = words.split_first().unwrap_or((&"--help", &[]));
    let help = match *command {
        "setup" => SETUP_HELP,
        "test" => TEST_HELP,
        "firmware" => FIRMWARE_HELP,
        "qemu" => QEMU_HELP,
        "virtual-board" => VIRTUAL_BOARD_HELP,
        "flash" => FLASH_HELP,
        "reproducible" => REPRODUCIBLE_HELP,
        "size" => SIZE_HELP,
        "instructions" => INSTRUCTIONS_HELP,
        "counts" => COUNTS_HELP,
        "bench" => BENCH_HELP,
        "cost" => COST_HELP,
        "against" => AGAINST_HELP,
        "dbc" => DBC_HELP,
        "architecture" => ARCHITECTURE_HELP,
        "mutants" => MUTANTS_HELP,
        "coverage" => COVERAGE_HELP,
        "--help" | "-h" | "help" => HELP,
        other => return Err(format!("no command {other:?}\n\n{HELP}")),
    };
    if help == HELP || matches!(rest.first(), Some(&"--help" | &"-h")) {
        print!("{help}");
        return Ok(ExitCode::SUCCESS);
    }
    match (*command, rest) {
        ("setup", _) => setup(target_source(rest, help)?)?,
        ("test", _) => test(rest)?,
        ("firmware", []) => image::build_all()?,
        ("qemu", [image, arguments @ ..]) => return run(image, arguments),
        ("virtual-board", _) => on_virtual_board(rest)?,
        ("flash", [image]) => image::flash(image)?,
        ("reproducible", []) => reproducible()?,
        ("dbc", []) => dbc()?,
        ("architecture", []) => architecture(image::root())?,
        ("counts", []) => counts(false)?,
        ("counts", ["--update"]) => counts(true)?,
        ("bench", []) => bench()?,
        ("cost", []) => cost()?,
        ("against", [commit]) => against(commit, 3)?,
        ("against", [commit, "--runs", runs]) => {
            let runs = runs.parse().ok().filter(|runs| (1..=100).contains(runs));
            against(commit, runs.ok_or_else(|| format!("--runs: a number from 1 to 100\n\n{help}"))?)?;
        }
        ("coverage", []) => coverage::coverage()?,
        ("mutants", _) => mutants(rest)?,
        ("size" | "instructions", []) => measure(command)?,
        _ => return Err(format!("wrong arguments\n\n{help}")),
    }
    Ok(ExitCode::SUCCESS)
}

fn target_source(arguments: &[&str], help: &str) -> Result<TargetSource> {
    match arguments {
        [] | ["--target-source", "auto"] => Ok(TargetSource::Auto),
        ["--target-source", "rustup"] => Ok(TargetSource::Rustup),
        ["--target-source", "debian"] => Ok(TargetSource::Debian),
        other => Err(format!("wrong arguments {other:?}\n\n{help}")),
    }
}

/// The tested packages: with the virtual board, whose emulated core declares a newer Rust version than it needs;
/// without those that run on the chip only.
const EVERYTHING: [&str; 8] = [
    "--workspace",
    "--exclude",
    "firmware",
    "--exclude",
    "no-panic",
    "--exclude",
    "steer-assist-python",
    "--ignore-rust-version",
];

fn test(words: &[&str]) -> Result<()> {
    let split = words.iter().position(|argument| *argument == "--").unwrap_or(words.len());
    let (rest, sample) = match words[..split] {
        [ref rest @ .., "--mutants", count] => (rest, Some(mutants::sample(count)?)),
        ref rest => (rest, None),
    };
    let (source, all) = match rest {
        [source @ .., "--all"] => (source, true),
        source => (source, false),
    };
    setup(target_source(source, TEST_HELP)?)?;
    let arguments = words.get(split + 1..).unwrap_or_default();
    let whole = !arguments.iter().any(|word| word.starts_with("-p") || word.starts_with("--package"));
    let python = whole.then(python::environment).flatten();
    image::build_all()?;
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    cargo.current_dir(paths::root()).arg("test").env("STEER_ASSIST_REQUIRE_QEMU", "1");
    if whole {
        cargo.args(EVERYTHING);
    }
    cargo.args(arguments);
    if all {
        let separator = (!arguments.contains(&"--")).then_some("--");
        cargo.env("STEER_ASSIST_SLOW", "1").args(separator).arg("--include-ignored");
    }
    progress::must_whenever(&mut cargo)?;
    python.map_or(Ok(()), |python| python::test(&python))?;
    sample.map_or(Ok(()), |sample| mutants::mutants(Some(sample), &[]))
}

fn mutants(arguments: &[&str]) -> Result<()> {
    let split = arguments.iter().position(|argument| *argument == "--").unwrap_or(arguments.len());
    let sample = match arguments[..split] {
        [] => None,
        ["--sample", count] => Some(mutants::sample(count)?),
        _ => return Err(format!("wrong arguments\n\n{MUTANTS_HELP}")),
    };
    mutants::mutants(sample, arguments.get(split + 1..).unwrap_or_default())
}

fn on_virtual_board(words: &[&str]) -> Result<()> {
    match words {
        ["--test", arguments @ ..] => {
            image::build_all()?;
            virtual_board::test(arguments)
        }
        _ => {
            virtual_board::build()?;
            match words {
                ["--build"] => Ok(()),
                ["--", arguments @ ..] | arguments => virtual_board::run(arguments),
            }
        }
    }
}

fn run(name: &str, arguments: &[&str]) -> Result<ExitCode> {
    image::build("board-qemu")?;
    let here = std::env::current_dir().map_err(|e| e.to_string())?;
    let outcome = qemu::run(name, arguments, &here, qemu::TIMED, Duration::from_secs(120))?;
    print!("{}", outcome.stdout);
    eprint!("{}", outcome.stderr);
    Ok(outcome.status.and_then(|status| u8::try_from(status).ok()).map_or(ExitCode::FAILURE, ExitCode::from))
}

fn measure(command: &str) -> Result<()> {
    image::build_all()?;
    let (sizes, counts) = document::regenerate()?;
    let sizes_only = command == "size";
    print!("{}", if sizes_only { size_table(&sizes) } else { instruction_table(&counts) });
    if !sizes_only {
        instructions::functions()?.iter().for_each(|f| println!("{}: {} instructions", f.name, f.mean));
    }
    let over = if sizes_only {
        document::over_budget(&sizes, &[])
    } else {
        [document::over_budget(&[], &counts), document::margin_too_small(&counts)].concat()
    };
    if over.is_empty() { Ok(()) } else { Err(format!("over budget, or too close:\n  {}", over.join("\n  "))) }
}
