//! Compares the rides' double-precision rate with the peak of this machine's core.

use crate::Result;
use crate::instructions::field;
use crate::paths::root;
use crate::process::capture;
use std::process::Command;
use std::time::Duration;

/// Operations of a right-hand side of one ride; a test counts them. A pair of sine and cosine counts as one.
pub const OPERATIONS: u32 = 1093;

const LIMIT: Duration = Duration::from_secs(3600);

/// Rates of one core \[operations/s\] as a table, with percent of the peak of separate products and sums.
///
/// # Errors
/// The program does not build or fails.
pub fn table() -> Result<String> {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    cargo.current_dir(root()).args(["bench", "--quiet", "--package", "motion", "--bench", "peak"]);
    let outcome = capture(&mut cargo, LIMIT)?;
    let rate = |name: &str, key: &str| -> Result<f64> {
        let is = |line: &&str| field::<String>(line, "name").as_deref() == Some(name);
        let found = outcome.stdout.lines().find(is).and_then(|line| field(line, key));
        found.ok_or_else(|| format!("no {name}: {outcome:?}"))
    };
    let peak = rate("products_and_sums", "operations_per_s")?;
    let of_sides = |name: &str| rate(name, "right_hand_sides_per_s").map(|rate| rate * f64::from(OPERATIONS));
    let rows = [
        ("peak, products and sums in turn", peak),
        ("peak, fused products and sums", rate("fused", "operations_per_s")?),
        ("right-hand sides, as many side by side as rides", of_sides("right_hand_side")?),
        ("small basin, of its right-hand sides alone", of_sides("basin")?),
    ];
    let row = |(name, rate): (&str, f64)| {
        format!("| {name} | {:.1} | {:.0} % |\n", rate * 1e-9, 100.0 * rate / peak)
    };
    let head = "| one core, double precision | 10^9 operations/s | of the first |\n| --- | ---: | ---: |\n";
    Ok(rows.into_iter().map(row).fold(head.into(), |table, row| table + &row))
}
