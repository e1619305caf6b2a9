//! Instructions of rides and basins on the host.

use std::io::Write;
use xtask::counts::{Counts, OTHER_COMPILER, TOLERANCE, impossible, measured, path, recorded};

/// Situation: the simulator in the release profile. Action: count the instructions of a right-hand side, a step of eight
/// rides, control steps, a ride and a small basin.
/// Must hold: each count is within 3 % of tests/data/instructions.toml, up and down; after an intended change
/// `cargo xtask counts --update`.
#[test]
fn the_instructions_of_a_basin_are_as_recorded() {
    if let Some(reason) = impossible() {
        // Not `eprintln`, which the test harness captures.
        let _ = writeln!(std::io::stderr(), "\nSKIPPED, NOT PASSED: {reason}\n");
        return;
    }
    let (now, recorded) = (measured().unwrap(), recorded().unwrap());
    print!("{}", now.table(&recorded));
    let text = "cargo xtask counts; if the change is intended, cargo xtask counts --update";
    assert_eq!(now.changed(&recorded), [""; 0], "{}: {text}", path().display());
}

/// Situation: counts that are equal, and 2.9 % and 3.1 % more and less; a piece of work that is only recorded; the same
/// with another compiler. Action: compare.
/// Must hold: only those beyond 3 %, with another compiler beyond 15 %, and the missing one are named.
#[test]
fn a_changed_count_is_named() {
    let counts = |rustc: &str, each: &[(&str, u64)]| Counts {
        rustc: rustc.into(),
        target: "x86_64-unknown-linux-gnu".into(),
        instructions: each.iter().map(|(name, count)| ((*name).to_owned(), *count)).collect(),
    };
    let names = |now: &Counts, recorded: &Counts| -> Vec<String> {
        let changed = now.changed(recorded);
        changed.iter().filter_map(|line| Some(line.split_once(':')?.0.to_owned())).collect()
    };
    let recorded =
        counts("1", &[("a", 1000), ("b", 1000), ("c", 1000), ("d", 1000), ("e", 1000), ("f", 1000)]);
    let measured = [("a", 1000), ("b", 1029), ("c", 1031), ("d", 971), ("e", 969)];
    assert_eq!(names(&counts("1", &measured), &recorded), ["c", "e", "f"]);
    assert_eq!(names(&counts("2", &measured), &recorded), ["f"]);
    assert_eq!(
        names(&counts("2", &[("a", 1151), ("b", 849)]), &counts("1", &[("a", 1000), ("b", 1000)])),
        ["a", "b"]
    );
    assert_eq!((TOLERANCE, OTHER_COMPILER), (0.03, 0.15));
}
