//! Writes a sweep study's answer as a page of Markdown.

use super::part_result::{Group, PartResult};
use super::threshold::LEAST;
use super::{Part, Study, Threshold, threshold};
use crate::basin::{Bound, Work};
use crate::sweep::{Axis, Grid};
use std::fmt::Write;

/// Cost of an answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spent {
    /// Time \[s\]; `None` if some cells existed before.
    pub seconds: Option<f64>,
    /// Threads.
    pub threads: usize,
}

/// The page of a study with complete sweeps. `figures` is the folder of the figures, relative to the page.
pub fn page(study: &Study, grids: &[Grid], spent: Spent, figures: &str) -> String {
    let tool = grids.first().map(|g| g.plan.tool.clone());
    let commit = tool.map_or(String::new(), |t| format!("{} {} commit {}", t.name, t.version, t.commit));
    let work =
        grids.iter().flat_map(|g| g.units.iter().flatten()).fold(Work::default(), |w, u| w.plus(&u.work));
    let mut text = format!("# {}\n\n{}\n\n", study.title, study.question.trim());
    let time = spent.seconds.map_or(String::new(), |s| {
        let minutes = s / 60.0;
        format!(" in {minutes:.1} min on {} threads", spent.threads)
    });
    let _ = writeln!(
        text,
        "This page is what `sim-host study {}` wrote ({commit}): {} rides, {:.1e} right-hand sides{time}.\n",
        study.name, work.rides, work.right_hand_sides as f64
    );
    for (part, grid) in study.parts.iter().zip(grids) {
        text += &section(study, part, grid, figures);
    }
    if !study.remarks.is_empty() {
        let _ = writeln!(text, "## Remarks\n\n{}", study.remarks.trim());
    }
    text
}

fn section(study: &Study, part: &Part, grid: &Grid, figures: &str) -> String {
    let mut text = format!("## {}\n\n", part.title);
    if !part.text.is_empty() {
        let _ = writeln!(text, "{}\n", part.text.trim());
    }
    let over: Vec<String> = part.over.iter().map(|axis| format!("--over {axis}")).collect();
    let _ = writeln!(
        text,
        "```sh\nsim-host sweep {} \\\n    {}\n```\n",
        part.options.typed(),
        over.join(" \\\n    ")
    );
    match PartResult::new(part, grid) {
        None => text += "Not every cell is computed.\n\n",
        Some(result) => match (result.numbers(part), &result.others[..]) {
            (None, _) => text += &compared(&result, grid),
            (Some(numbers), []) => text += &alone(&result, &numbers, grid),
            (Some(numbers), _) => {
                text += &(together(&result, &numbers) + &accuracy(&result, grid) + &bounds(&result, grid));
            }
        },
    }
    for (name, _) in super::figures(part, grid) {
        let _ = writeln!(text, "![{}]({figures}/{}-{name}.svg)\n", part.title, study.name);
    }
    text
}

/// Position at which a line of a group falls below [`LEAST`]; `None` if a value on it is only a bound.
fn found(group: &Group, line: usize, numbers: &[(usize, f64)]) -> Option<Threshold> {
    let part = |i: usize| group.part(line, i).map_or(f64::NAN, |p| p.0);
    let points: Vec<(f64, f64)> = numbers.iter().map(|&(i, x)| (x, part(i))).collect();
    group.measured(line).then(|| threshold(&points, LEAST))
}

fn in_words(found: Option<Threshold>, numbers: &[(usize, f64)], unit: &str) -> String {
    let last = numbers[numbers.len() - 1].1;
    let Some(found) = found else { return REFUSED.into() };
    match found {
        Threshold::Everywhere => format!("{last}{unit} keeps it"),
        Threshold::Nowhere => "lost".into(),
        Threshold::Until { at, kept, lost } => {
            let digits = (2 - libm::log10(at.abs().max(1e-9)).floor() as i32).max(0) as usize;
            let (low, high) = (kept.min(lost), kept.max(lost));
            format!("{at:.digits$}{unit} ({low}{unit} to {high}{unit})")
        }
    }
}

/// Text where areas are only lower bounds.
const REFUSED: &str = "not known: capped";

/// A number with its kind of bound.
fn bounded(x: f64, bound: Bound, digits: usize) -> String {
    format!("{}{x:.digits$}", bound.sign())
}

/// Note below tables that contain a bound.
fn bounds(result: &PartResult, grid: &Grid) -> String {
    let measured = |group: &Group| (0..group.lines.len()).all(|line| group.measured(line));
    if result.groups.iter().all(measured) {
        return String::new();
    }
    format!(
        "Nothing fell up to {} rad/s at some speeds: `>=` is at least, `<=` at most, `~` neither; what keeps {:.0} % \
         is not known where {}s are such bounds.\n\n",
        grid.plan.search.max_rate,
        100.0 * LEAST,
        result.what
    )
}

/// Most values of an axis in one table; with more, every fourth is shown.
const BESIDE: usize = 8;

/// Table for a single axis: a row per group.
fn alone(result: &PartResult, (numbers, unit): &(Vec<(usize, f64)>, String), grid: &Grid) -> String {
    let key = &result.along.key;
    let shown: Vec<(usize, f64)> =
        numbers.iter().copied().step_by(if numbers.len() > BESIDE { 4 } else { 1 }).collect();
    let mut text = format!(
        "| group | {} of the reference, {} | {key} that keeps {:.0} % (grid) | part of the {} at {} |\n| --- | --- | --- | --- |\n",
        result.what,
        result.unit,
        100.0 * LEAST,
        result.what,
        shown.iter().map(|n| format!("{}{unit}", n.1)).collect::<Vec<_>>().join(", ")
    );
    for group in &result.groups {
        let parts: Vec<String> = shown.iter().map(|n| share(group, 0, n.0)).collect();
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} |",
            group.label,
            bounded(group.reference, group.reference_is, 2),
            in_words(found(group, 0, numbers), numbers, unit),
            parts.join(", ")
        );
    }
    text += "\nInterpolated between the two values of the grid in parentheses, which are the bounds of its error. ";
    text + &accuracy(result, grid) + &bounds(result, grid)
}

/// Fraction of the reference's area for a line of a group at a position of the axis.
fn share(group: &Group, line: usize, place: usize) -> String {
    group.part(line, place).map_or("-".into(), |(part, is)| bounded(100.0 * part, is, 1) + " %")
}

/// Table for two axes: the fraction of the area in each cell, a table per group.
fn shares(result: &PartResult, group: &Group, rows: &Axis) -> String {
    let along = &result.along;
    let mut text = format!(
        "{}: part of {} {}.\n\n| {} \\ {} | {} |\n| --- {}|\n",
        group.label,
        bounded(group.reference, group.reference_is, 2),
        result.unit,
        rows.key,
        along.key,
        along.values.join(" | "),
        "| --- ".repeat(along.values.len())
    );
    for (line, row) in rows.values.iter().enumerate() {
        let cells: Vec<String> = (0..along.values.len()).map(|place| share(group, line, place)).collect();
        let _ = writeln!(text, "| {row} | {} |", cells.join(" | "));
    }
    text + "\n"
}

/// Accuracy of areas; of heights at a single speed.
fn accuracy(result: &PartResult, grid: &Grid) -> String {
    let (speeds, tolerance) = (&grid.plan.search.speeds, grid.plan.search.tolerance);
    if grid.one_speed() {
        return format!("Heights are located within {tolerance} rad/s.\n\n");
    }
    let span = speeds.last().unwrap_or(&0.0) - speeds.first().unwrap_or(&0.0);
    let least = result.groups.iter().map(|g| g.reference).fold(f64::INFINITY, f64::min);
    format!(
        "Heights are located within {tolerance} rad/s, areas thus within {:.2} rad m/s^2, {:.1} % of the smallest \
         reference.\n\n",
        tolerance * span,
        100.0 * tolerance * span / least
    )
}

fn capital(word: &str) -> String {
    word[..1].to_uppercase() + &word[1..]
}

/// Tables for several axes: one per group, with the reference's other axes as rows and columns.
fn together(result: &PartResult, (numbers, unit): &(Vec<(usize, f64)>, String)) -> String {
    let key = &result.along.key;
    let (rows, columns) = (&result.others[0], result.others.get(1));
    let across = columns.map_or(1, |axis| axis.values.len());
    let mut text = String::new();
    for group in &result.groups {
        let _ = writeln!(
            text,
            "{}: {key} that keeps {:.0} % of {} {} (interpolated, between the grid's values in parentheses; \"lost\" at every value of the grid).\n",
            group.label,
            100.0 * LEAST,
            bounded(group.reference, group.reference_is, 2),
            result.unit
        );
        let names: Vec<&str> =
            columns.map_or(vec![key.as_str()], |axis| axis.values.iter().map(String::as_str).collect());
        let corner = columns.map_or(rows.key.clone(), |axis| format!("{} \\ {}", rows.key, axis.key));
        let _ = writeln!(text, "| {corner} | {} |\n| --- {}|", names.join(" | "), "| --- ".repeat(across));
        for (i, row) in rows.values.iter().enumerate() {
            let cell = |j| in_words(found(group, i * across + j, numbers), numbers, unit);
            let cells: Vec<String> = (0..across).map(cell).collect();
            let _ = writeln!(text, "| {row} | {} |", cells.join(" | "));
        }
        text.push('\n');
        if columns.is_none() {
            text += &shares(result, group, rows);
        }
    }
    text
}

/// Table for an axis of names: the area at each, beside the reference's.
fn compared(result: &PartResult, grid: &Grid) -> String {
    let names: Vec<String> =
        result.along.values.iter().map(|v| format!("{} {v}", result.along.key)).collect();
    let mut text = format!("| group | {} |\n| --- {}|\n", names.join(" | "), "| --- ".repeat(names.len()));
    for group in &result.groups {
        for line in &group.lines {
            let cell = |area: &Option<(f64, Bound)>| {
                let Some((a, bound)) = *area else { return "-".into() };
                let is = Bound::of_ratio(!bound.is_measured(), !group.reference_is.is_measured());
                let change = 100.0 * (a / group.reference - 1.0);
                format!("{} ({}{change:+.2} %)", bounded(a, bound, 3), is.sign())
            };
            let cells: Vec<String> = line.iter().map(cell).collect();
            let _ = writeln!(text, "| {} | {} |", group.label, cells.join(" | "));
        }
    }
    let _ = write!(
        text,
        "\n{}s in {}, and their difference to the reference. ",
        capital(result.what),
        result.unit
    );
    text + &accuracy(result, grid) + &bounds(result, grid)
}
