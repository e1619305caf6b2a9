//! Writes `docs/images.md` with sizes and instruction counts (`cargo xtask size`, `cargo xtask instructions`); a test
//! compares the committed numbers with fresh ones.

use crate::instructions::{
    BUDGET, Count, EVERYTHING_MARGIN_PERCENT, MARGIN_PERCENT, MOTOR_BUDGET, STACK_BUDGET, with_margin,
};
use crate::paths::root;
use crate::size::Size;
use crate::{Result, instructions, size};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Largest relative difference between a committed and a fresh number, so that a patch release of the compiler needs no
/// update.
const TOLERANCE: f64 = 0.03;

/// Path of the document.
pub fn path() -> PathBuf {
    root().join("docs/images.md")
}

/// Text of the document for these measurements.
pub fn text(sizes: &[Size], counts: &[Count]) -> String {
    format!(
        "# Images in numbers

Written by `cargo xtask size` and `cargo xtask instructions`; a test compares it with fresh numbers.

## Size

Bytes, profile `firmware`. Flash is text + data, RAM is data + bss + 32 KiB of stack.

{}
## Instructions of a control step and of the motor's loop

Counted in QEMU, call included: over the border ride of law h, with gyro and front wheel; over a ride with every
sensor; over that ride with each sensor lost, wrong or out of range from its middle on; and over the last two with all sensors
slower than the control, a sample in each second, fifth or eighth period and all in the same one. At most {BUDGET} are
allowed, of the 168,000 clock cycles of a period. Of the motor's loop each call is counted, at six torques and speeds, then while
it breaks in nine ways; at most {MOTOR_BUDGET} are allowed, of the 4,200 cycles of its shortest period (40 kHz). Instructions
are not cycles: the chip adds wait states of the flash, divisions of 14 cycles and interrupts. The stack is painted before and
looked at after; at most {STACK_BUDGET} bytes are allowed.

Of both budgets {MARGIN_PERCENT} % must stay free, which a test checks: no more than {} instructions in the largest step, {} in the
largest call of the motor's loop; {EVERYTHING_MARGIN_PERCENT} %, which leaves {}, where everything is on at once, which is not flashed. The same source and compiler give code that differs by about one percent from machine to
machine.

{}",
        size_table(sizes),
        with_margin(BUDGET, MARGIN_PERCENT),
        with_margin(MOTOR_BUDGET, MARGIN_PERCENT),
        with_margin(BUDGET, EVERYTHING_MARGIN_PERCENT),
        instruction_table(counts)
    )
}

/// The table of sizes.
pub fn size_table(sizes: &[Size]) -> String {
    let head = "| image | text | data | bss | flash | of | RAM | of |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n";
    let row = |s: &Size| {
        let Size { name, text, data, bss, flash_budget, ram_budget } = *s;
        let (flash, ram) = (s.flash(), s.ram());
        format!("| {name} | {text} | {data} | {bss} | {flash} | {flash_budget} | {ram} | {ram_budget} |\n")
    };
    sizes.iter().map(row).fold(head.into(), |table: String, row| table + &row)
}

/// The table of instruction counts.
pub fn instruction_table(counts: &[Count]) -> String {
    let head = "| configuration | mean | largest | stack \\[bytes\\] |\n| --- | ---: | ---: | ---: |\n";
    let row = |c: &Count| format!("| {} | {} | {} | {} |\n", c.name, c.mean, c.max, c.stack);
    counts.iter().map(row).fold(head.into(), |table: String, row| table + &row)
}

/// `page` with the text between the comments `<!-- table NAME -->` and `<!-- end -->` replaced by a table. Fails if it has no
/// place for the table.
pub(crate) fn with_table(page: &str, name: &str, table: &str) -> Result<String> {
    let (start, end) = (format!("<!-- table {name} -->\n"), "<!-- end -->");
    let (before, rest) = page.split_once(&start).ok_or_else(|| format!("no line `{}`", start.trim_end()))?;
    let (_, after) =
        rest.split_once(end).ok_or_else(|| format!("no `{end}` after `{}`", start.trim_end()))?;
    Ok(format!("{before}{start}{table}{end}{after}"))
}

/// Measures everything and writes the document.
///
/// # Errors
/// A measurement failed, the file cannot be written, or an image or a step is over its budget.
pub fn regenerate() -> Result<(Vec<Size>, Vec<Count>)> {
    let (sizes, counts) = (size::sizes()?, instructions::counts()?);
    std::fs::write(path(), text(&sizes, &counts)).map_err(|e| format!("{}: {e}", path().display()))?;
    Ok((sizes, counts))
}

/// Lists images and steps over their budget.
pub fn over_budget(sizes: &[Size], counts: &[Count]) -> Vec<String> {
    let images = sizes.iter().filter(|s| s.is_over()).map(|s| {
        let (flash, ram) = (s.flash(), s.ram());
        format!("{}: flash {flash} of {}, RAM {ram} of {} bytes", s.name, s.flash_budget, s.ram_budget)
    });
    let steps = counts.iter().filter(|c| c.max > c.budget);
    let steps = steps.map(|c| format!("{}: {} of {} instructions", c.name, c.max, c.budget));
    let deep = counts.iter().filter(|c| c.stack > STACK_BUDGET);
    let deep = deep.map(|c| format!("{}: {} of {STACK_BUDGET} bytes of stack", c.name, c.stack));
    images.chain(steps).chain(deep).collect()
}

/// The rows of instruction counts within their budget but with less than the required margin.
pub fn margin_too_small(counts: &[Count]) -> Vec<String> {
    let close = counts.iter().filter(|c| c.max > c.most() && c.max <= c.budget);
    close
        .map(|c| {
            let (most, budget, percent) = (c.most(), c.budget, c.margin_percent());
            format!(
                "{}: {} instructions, more than the {most} that leave {percent} % of {budget} free",
                c.name, c.max
            )
        })
        .collect()
}

/// The rows in which the committed text differs from the fresh one by more than the tolerance.
pub fn stale(committed: &str, fresh: &str) -> Vec<String> {
    let (committed, fresh) = (rows(committed), rows(fresh));
    let close = |a: &[f64], b: &[f64]| {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= TOLERANCE * a.max(*b))
    };
    let names = committed.keys().chain(fresh.keys().filter(|name| !committed.contains_key(*name)));
    names
        .filter(|name| !matches!((committed.get(*name), fresh.get(*name)), (Some(a), Some(b)) if close(a, b)))
        .map(|name| format!("{name}: committed {:?}, now {:?}", committed.get(name), fresh.get(name)))
        .collect()
}

/// The tables' rows: the first cell and the numbers of the others.
fn rows(text: &str) -> BTreeMap<String, Vec<f64>> {
    let cells = |line: &str| line.split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
    text.lines()
        .filter(|line| line.starts_with("| "))
        .map(cells)
        .filter_map(|row| {
            let numbers = row.get(2..row.len() - 1)?.iter().map(|cell| cell.parse().ok());
            Some((row.get(1)?.clone(), numbers.collect::<Option<Vec<f64>>>()?))
        })
        .collect()
}
