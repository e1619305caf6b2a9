//! Plots a basin as columns of block characters.

use super::braille::{MARGIN, margin, x_axis};
use crate::basin::{Basin, Column};
use crate::report::figure::scale::{nice, ticks};
use crate::ride::Outcome;

const ROWS: usize = 14;
const EIGHTHS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
const UNDECIDED: char = '▒';
const ISLAND: char = '▓';
const CAPPED: char = '▲';

/// The range of a basin's speeds \[m/s\].
pub(super) fn span(basin: &Basin) -> (f64, f64) {
    let speed = |c: Option<&Column>, or: f64| c.map_or(or, |c| c.speed);
    wide((speed(basin.columns.first(), 0.0), speed(basin.columns.last(), 1.0)))
}

/// The range, or for a single speed one around it \[m/s\].
pub(super) fn wide((first, last): (f64, f64)) -> (f64, f64) {
    if first < last { (first, last) } else { (first - 0.5, first + 0.5) }
}

/// The plot over the speeds `x` \[m/s\], `width` characters wide.
pub(super) fn plot(basin: &Basin, title: &str, x: (f64, f64), width: usize) -> String {
    let across = width - MARGIN;
    let reach = basin.columns.iter().flat_map(|c| c.islands.iter().map(|i| i.to).chain([c.upper]));
    let top = nice(reach.chain([0.0]), 6).1;
    let shown: Vec<Option<&Column>> = (0..across).map(|i| nearest(basin, x, i, across)).collect();

    let capped: String =
        shown.iter().map(|c| if c.is_some_and(|c| c.capped) { CAPPED } else { ' ' }).collect();
    let mut text = format!("{title}\n");
    if capped.contains(CAPPED) {
        text += &format!("{:MARGIN$}{}\n", "", capped.trim_end());
    }
    let height = top / ROWS as f64;
    let numbers = ticks((0.0, top), ROWS / 2);
    let mut signs = String::new();
    for row in (0..ROWS).rev() {
        let (low, high) = (row as f64 * height, (row + 1) as f64 * height);
        let number =
            numbers.iter().find(|(v, _)| *v > low + 1e-9 && *v <= high + 1e-9 || *v <= 0.0 && row == 0);
        let line: String = shown.iter().map(|c| c.map_or(' ', |c| sign(c, low, high))).collect();
        text += &margin(number.map(|(_, n)| n.as_str()));
        text += line.trim_end();
        text.push('\n');
        signs += &line;
    }
    text += &x_axis(across, x, "forward speed [m/s]");
    let meanings = [
        (UNDECIDED, "upright at the time limit, not settled"),
        (ISLAND, "above a fall, but does not fall itself"),
        (CAPPED, "no fall up to the largest rate tried"),
    ];
    let used = meanings.iter().filter(|(sign, _)| signs.contains(*sign) || capped.contains(*sign));
    for (sign, meaning) in used {
        text += &format!("{sign} {meaning}\n");
    }
    text
}

/// The column closest to character `i` of `across`.
fn nearest(basin: &Basin, x: (f64, f64), i: usize, across: usize) -> Option<&Column> {
    let v = x.0 + (x.1 - x.0) * i as f64 / (across - 1) as f64;
    basin.columns.iter().min_by(|a, b| (a.speed - v).abs().total_cmp(&(b.speed - v).abs()))
}

/// Character for disturbances from `low` to `high`.
fn sign(column: &Column, low: f64, high: f64) -> char {
    let middle = 0.5 * (low + high);
    let eighths = ((column.upper - low) / (high - low) * 8.0).round().clamp(0.0, 8.0) as usize;
    let closest =
        || column.scan.iter().min_by(|a, b| (a.rate - middle).abs().total_cmp(&(b.rate - middle).abs()));
    if eighths == 8 && closest().is_some_and(|p| p.outcome == Outcome::Undecided) {
        UNDECIDED
    } else if eighths == 0 && column.islands.iter().any(|i| i.from < high && i.to > low) {
        ISLAND
    } else {
        EIGHTHS[eighths]
    }
}
