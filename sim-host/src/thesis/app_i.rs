//! Appendix I: heights of the basins of reduced sets of gains, each constant at the speed of its run.

use super::constant::{constant, disturbed, ridden};
use super::draw::SPEED;
use super::item::{Figure, Item, Value};
use super::published::{Cell, GainRow, Heights, cells, height_cell, published};
use super::study::Study;
use crate::basin::{Axis as Disturbed, Column, Method, Search, border, borders, column};
use crate::report::figure::{Axis, Chart, Line, Look, Marker, Plot, Series};
use crate::ride::{Conditions, Effort, Ride, Start, rides, side_by_side};
use crate::rider::Gains;
use rayon::prelude::*;
use std::sync::Arc;

/// The grid of disturbances of Tables I.1 and I.2 \[rad/s\]: "± 0.1".
const GRID: f64 = 0.1;
const ON_GRID: &str = "the first multiple of 0.1 rad/s that falls";

/// A gain set of Table I.1 or I.2 and its basin at its run's speed.
#[derive(Debug)]
pub(super) struct Set {
    of: &'static Heights,
    row: &'static GainRow,
    /// Number within its run, from 1.
    number: usize,
    column: Column,
}

impl Set {
    fn exact(&self) -> f64 {
        self.column.upper
    }

    /// The first disturbance on [`GRID`] that falls \[rad/s\]: the first fall of the scan, or the first multiple beyond
    /// the border of a scan with larger steps.
    fn on_grid(&self) -> f64 {
        first_multiple_after(self.exact())
    }

    /// Whether Table I.1 omits the set although its run is legible.
    fn is_left_out(&self) -> bool {
        self.of.recovered.is_none() && self.row.height.is_nan()
    }

    fn conditions(&self, study: &Study) -> Conditions {
        ridden(study, constant(Gains::of_states(&self.row.gains), self.of.delay_ms * 1e-3))
    }
}

fn first_multiple_after(rate: f64) -> f64 {
    multiple((rate / GRID + 1e-9).floor() + 1.0)
}

/// The `n`th disturbance on [`GRID`], rounded to its digits \[rad/s\].
fn multiple(n: f64) -> f64 {
    (n * GRID * 1e9).round() / 1e9
}

fn search(scan_step: f64) -> Search {
    Search {
        speeds: Vec::new(),
        axis: Disturbed::SteerRate,
        max_rate: 15.0,
        scan_step,
        tolerance: 0.005,
        method: Method::Fast,
        efforts: false,
    }
}

/// Step of a scan that finds only wide gaps in the basin.
const WIDE: f64 = 0.5;

/// Step of the tables' scan: the whole grid, except in a quick study.
fn fine(study: &Study) -> f64 {
    if study.quick { WIDE } else { GRID }
}

/// The gain sets of a table, scanned in steps of `scan_step` \[rad/s\], stored or computed now.
fn sets(study: &Study, table: &'static str, scan_step: f64) -> Arc<Vec<Set>> {
    study.heights.get((table, scan_step), || scanned(study, table, scan_step))
}

fn scanned(study: &Study, table: &str, scan_step: f64) -> Vec<Set> {
    let of_table = published().height.iter().filter(|h| h.table == table);
    let all: Vec<(&Heights, usize, &GainRow)> =
        of_table.flat_map(|h| h.rows.iter().enumerate().map(move |(i, row)| (h, i + 1, row))).collect();
    all.into_par_iter()
        .map(|(of, number, row)| {
            let conditions = ridden(study, constant(Gains::of_states(&row.gains), of.delay_ms * 1e-3));
            Set { of, row, number, column: border(&conditions, &search(scan_step), of.speed) }
        })
        .collect()
}

/// Table I.1: the young cyclist's.
pub(super) fn table_i_1(study: &Study) -> Item {
    let sets = sets(study, "I.1", fine(study));
    let unreadable = sets.iter().filter(|s| s.row.height.is_nan()).count();
    let note = format!(
        "{unreadable} of the sets of Table F.3 with more than 90 % have no height here: those of runs 252, 190 and 256 \
         can't be read in the copy at hand, two are left out of Table I.1. The mean of all rows includes them."
    );
    Item { values: heights(study, "table-I.1", &sets, None), notes: vec![reading(), note], ..Item::default() }
}

/// Table I.2: the old cyclist's.
pub(super) fn table_i_2(study: &Study) -> Item {
    let young = sets(study, "I.1", WIDE);
    let old = sets(study, "I.2", fine(study));
    Item {
        values: heights(study, "table-I.2", &old, Some(&young)),
        notes: vec![reading()],
        ..Item::default()
    }
}

fn reading() -> String {
    format!(
        "Exact: the border of the basin. On the grid: {ON_GRID}, which is what the tables print; they give their \
         heights “± 0.1”."
    )
}

/// Every printed height beside the computed one, then the means in the text.
fn heights(study: &Study, item: &str, sets: &[Set], young: Option<&[Set]>) -> Vec<Value> {
    let rows: Vec<Value> = sets
        .par_iter()
        .map(|set| {
            let cell = height_cell(set.of, set.number);
            let value = Value { capped: set.column.capped, ..Value::new(cell, Some(set.exact())) };
            let value = value.on_grid_of(Some(set.on_grid()), ON_GRID);
            let far = |printed: f64| (set.on_grid() - printed).abs() > 1.5 * GRID;
            if value.cell.printed.is_some_and(|p| far(p.value)) {
                tried(study, sets, set, value)
            } else {
                value
            }
        })
        .collect();
    let means = cells(item).into_iter().filter(|cell| !cell.row.starts_with("run ")).map(|cell: Cell| {
        let of = |height: fn(&Set) -> f64| match cell.row.as_str() {
            "mean of all rows" => mean(&sets.iter().map(height).collect::<Vec<_>>()),
            "mean of the lowest of every run" => mean(&of_runs(sets, height, f64::min)),
            "mean of the highest of every run" => mean(&of_runs(sets, height, f64::max)),
            _ => {
                let old = mean(&of_runs(sets, height, f64::max));
                let young = young.map_or(f64::NAN, |y| mean(&of_runs(y, height, f64::min)));
                100.0 * (young - old) / young
            }
        };
        let printed = |set: &Set| if set.row.height.is_nan() { set.on_grid() } else { set.row.height };
        let (exact, coarse) = (of(Set::exact), of(Set::on_grid));
        let all_rows = cell.row == "mean of all rows";
        let capped = sets.iter().chain(young.unwrap_or_default()).any(|set| set.column.capped);
        let value = Value { capped, ..Value::new(cell.clone(), Some(exact)) };
        let mut value = value.on_grid_of(Some(coarse), ON_GRID);
        if all_rows && sets.iter().any(Set::is_left_out) {
            let selected = sets.iter().filter(|s| !s.is_left_out());
            let name = "the same without the two sets of Table F.3 that Table I.1 leaves out";
            value = value.tried(name, mean(&selected.map(Set::on_grid).collect::<Vec<_>>()));
        }
        value.tried("of the printed heights, computed ones where none can be read", of(printed))
    });
    rows.into_iter().chain(means).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// One height per run, selected by `pick`.
fn of_runs(sets: &[Set], height: fn(&Set) -> f64, pick: fn(f64, f64) -> f64) -> Vec<f64> {
    let runs = sets.chunk_by(|a, b| a.of.run == b.of.run);
    runs.filter_map(|run| run.iter().map(height).reduce(pick)).collect()
}

/// A height that differs from the print, under other readings.
fn tried(study: &Study, sets: &[Set], set: &Set, value: Value) -> Value {
    let conditions = set.conditions(study);
    let height = |c: &Conditions| first_multiple_after(border(c, &search(WIDE), set.of.speed).upper);
    let mut value = value;
    for other in sets.iter().filter(|s| s.of.run == set.of.run && s.number != set.number) {
        value = value.tried(&format!("gains of set {}", other.number), other.on_grid());
    }
    for seconds in [3.0, 12.0] {
        let name = format!("rides of {seconds} s");
        value = value.tried(&name, height(&Conditions { time_limit_s: seconds, ..conditions.clone() }));
    }
    let delay_s = if set.of.delay_ms > 45.0 { 0.03 } else { 0.06 };
    let name = format!("a delay of {} ms", delay_s * 1e3);
    value = value.tried(&name, height(&ridden(study, constant(Gains::of_states(&set.row.gains), delay_s))));
    let whole = column(&conditions, &search(GRID), set.of.speed);
    let standing = whole.scan.iter().filter(|p| p.outcome.time_to_fall_s().is_none());
    let last = standing.map(|p| p.rate).fold(0.0, f64::max);
    value =
        value.tried("the largest multiple of 0.1 rad/s that does not fall", multiple((last / GRID).round()));
    let speeds: [f64; 2] = [-0.1, 0.1].map(|d| set.of.speed + d);
    for Column { speed, upper, .. } in borders(&conditions, &search(WIDE), &speeds) {
        let name = format!("a speed of {speed:.1} m/s");
        value = value.tried(&name, first_multiple_after(upper));
    }
    value.tried("a fall is 45 degrees of roll or steer", first_beyond(&conditions, set.of.speed, 45.0))
}

/// The first multiple of [`GRID`] at which a ride exceeds `degrees` of roll or steer, or falls \[rad/s\].
fn first_beyond(conditions: &Conditions, speed: f64, degrees: f64) -> f64 {
    let multiples: Vec<f64> = (1..150).map(|i| multiple(f64::from(i))).collect();
    let beyond = |ride: &Ride| {
        let Effort { peak_roll_rad, peak_steer_rad, .. } = ride.effort;
        ride.fell() || peak_roll_rad.max(peak_steer_rad) > degrees.to_radians()
    };
    let first = multiples.chunks(side_by_side()).find_map(|some| {
        let starts: Vec<Start> = some.iter().map(|&rate| disturbed(speed, rate)).collect();
        rides(conditions, &starts).iter().position(beyond).map(|first| some[first])
    });
    first.unwrap_or(f64::NAN)
}

/// Figure I.1: the heights over the runs' speeds.
pub(super) fn figure_i_1(study: &Study) -> Item {
    let both = [("I.1", "30 ms", 0, Marker::Dot, -0.04), ("I.2", "60 ms", 1, Marker::Square, 0.04)];
    let series = both.map(|(table, delay, colour, marker, aside)| {
        let sets = sets(study, table, WIDE);
        // Side by side, since the two cyclists rode at the same speeds.
        let points = |of: &dyn Fn(&Set) -> f64| -> Vec<(f64, f64)> {
            sets.iter().map(|s| (s.of.speed + aside, of(s))).filter(|p| p.1.is_finite()).collect()
        };
        let runs = sets.chunk_by(|a, b| a.of.run == b.of.run);
        let means = runs.map(|run| {
            let heights: Vec<f64> = run.iter().map(Set::exact).collect();
            (run[0].of.speed + aside, mean(&heights))
        });
        let means = means.collect();
        [
            Series::new(format!("{delay}, mean of a run"), Look::line(colour, Line::Solid), means),
            Series::new(format!("{delay}, computed"), Look::marks(colour, marker), points(&Set::exact)),
            Series::new(
                format!("{delay}, printed"),
                Look::marks(colour, Marker::Cross),
                points(&|s| s.row.height),
            ),
        ]
    });
    let plot = Plot {
        x: Axis::new(SPEED).over(1.5, 8.0),
        y: Axis::new("Height of the basin [rad/s]").over(0.0, 12.0),
        series: series.into_iter().flatten().collect(),
        ..Plot::default()
    };
    let title = "Heights of the basins of reduced gain sets".to_owned();
    let chart = Chart { title, columns: 1, plots: vec![plot], shaded: String::new() };
    let caption = "Height of the basin of every gain set of Tables I.1 and I.2 at the speed of its run, for the neural \
                   delays of 30 and 60 ms, drawn a little aside of one another. Crosses: as printed, which is the \
                   first multiple of 0.1 rad/s that falls.";
    Item { figures: vec![Figure::of_chart("figure-I.1", caption, &chart)], ..Item::default() }
}
