//! Appendix J: the cyclist without neural delay.

use super::case::Case;
use super::ch3_riders::{all_fits, of_rider, outlines};
use super::cyclist::{Cyclist, fit_name, fit_named};
use super::draw::{SPEED, outline, same_name, sorted_lines, speeds};
use super::figures_of_merit::merit;
use super::heights::{Outline, area};
use super::item::{Figure, Item, Value};
use super::study::Study;
use crate::eigen::{Feedback, Model, Stability, roots, stability};
use crate::report::figure::{Axis, Chart, Line, Look, Marker, Plot, Series};
use crate::rider::Fit;
use crate::rider::catalogue::load;
use control::Law;

fn undelayed(fit: Fit) -> Cyclist {
    Cyclist::undelayed(fit, 0)
}

fn model(study: &Study, fit: Fit) -> Model {
    Model::new(&study.parameters, Feedback::Law(Law::None), Some(undelayed(fit).rider()))
}

/// The longest stable range of speeds \[m/s\].
fn longest(stability: &Stability) -> Option<(f64, f64)> {
    stability.ranges.iter().copied().max_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0)))
}

/// Figure J.1: the variance accounted for, by two choices of four gains.
pub(super) fn figure_j_1(_: &Study) -> Item {
    let tables = [("Table J.2", "undelayed"), ("Table J.3", "undelayed-alt")];
    let mut series = Vec::new();
    for (i, (label, name)) in tables.into_iter().enumerate() {
        let Ok(table) = load(name) else { continue };
        let mut vafs: Vec<f64> = table.rows.iter().filter_map(|r| r.vaf).collect();
        vafs.sort_by(f64::total_cmp);
        let x = 1.0 + i as f64;
        let q = |part: f64| quantile(&vafs, part);
        let (left, right) = (x - 0.15, x + 0.15);
        let (low, high) = (q(0.25), q(0.75));
        let shape = vec![
            (x, q(0.0)),
            (x, low),
            (left, low),
            (left, high),
            (x, high),
            (x, q(1.0)),
            (x, high),
            (right, high),
            (right, low),
            (x, low),
        ];
        series.push(Series::new(label, Look::line(i, Line::Solid), shape));
        series.push(Series::new(
            "median",
            Look::line(4, Line::Dashed),
            vec![(left, q(0.5)), (right, q(0.5))],
        ));
        let runs = vafs.iter().map(|&vaf| (x + 0.25, vaf)).collect();
        series.push(Series::new("runs", Look::marks(4, Marker::Point), runs));
    }
    let plot = Plot {
        x: Axis::new("left: Table J.2, right: Table J.3").over(0.5, 2.5),
        y: Axis::new("Variance accounted for [%]"),
        series,
        ..Plot::default()
    };
    let title = "Variance accounted for by two choices of four gains".to_owned();
    let chart = Chart { title, columns: 1, plots: vec![plot], shaded: String::new() };
    let caption = "Boxes from the first to the third quartile, whiskers to the least and the highest, every run beside \
                   them. The VAFs are as printed.";
    Item { figures: vec![Figure::of_chart("figure-J.1", caption, &chart)], ..Item::default() }
}

/// A quantile, interpolated linearly between order statistics; NaN for an empty list.
fn quantile(sorted: &[f64], part: f64) -> f64 {
    let at = part * sorted.len().saturating_sub(1) as f64;
    let (low, high) = (sorted.get(at.floor() as usize), sorted.get(at.ceil() as usize));
    low.zip(high).map_or(f64::NAN, |(low, high)| low + at.fract() * (high - low))
}

/// Table J.4: speeds at which the undelayed rider's straight ride is stable.
pub(super) fn table_j_4(study: &Study) -> Item {
    let all = Fit::THESIS.map(|fit| stability(&model(study, fit)));
    let values = Item::compare("table-J.4", |cell| {
        let found = fit_named(&cell.column).and_then(|fit| Fit::THESIS.iter().position(|f| *f == fit));
        let Some(of) = found.and_then(|i| all[i].as_ref()) else { return Value::new(cell, None) };
        let weave = cell.row == "v_w";
        let end = longest(of).map(|range| if weave { range.0 } else { range.1 });
        let zero = if weave { of.critical.v_w } else { of.critical.v_c };
        let name = if weave { "where a pair ceases to grow" } else { "where a real root begins to grow" };
        Value::new(cell, end).tried(name, zero.unwrap_or(f64::NAN))
    });
    let note = "The printed speeds are the ends of the range without a growing root, whatever root ends it.";
    Item { values, notes: vec![note.into()], ..Item::default() }
}

/// States of the model: four of the bicycle, the steer integral, the neuromuscular torque and its rate.
const STATES: usize = 7;

/// Figure J.3: eigenvalues of the undelayed rider.
pub(super) fn figure_j_3(study: &Study) -> Item {
    let grid = speeds(12.0, if study.quick { 240 } else { 600 });
    let plot = |fit: Fit| {
        let model = model(study, fit);
        let at = |v: f64| roots(&model.at(v), STATES).iter().map(|e| (e.re, e.im)).collect();
        let lines = sorted_lines(&grid, at);
        let real = same_name("real part [1/s]", Look::line(0, Line::Solid), lines.real);
        let imaginary = same_name("imaginary part [rad/s]", Look::line(1, Line::Dashed), lines.imaginary);
        Plot {
            title: fit_name(fit).into(),
            x: Axis::new(SPEED).over(0.0, 12.0),
            y: Axis::new("Eigenvalue λ").over(-10.0, 10.0),
            series: [real, imaginary].concat(),
            shaded: stability(&model).iter().filter_map(longest).collect(),
            ..Plot::default()
        }
    };
    let chart = Chart {
        title: "Eigenvalues of the undelayed rider".into(),
        columns: 2,
        plots: Fit::THESIS.map(plot).to_vec(),
        shaded: "stable".into(),
    };
    let caption = "Eigenvalues of the linearised bicycle with the undelayed rider, neuromuscular dynamics and steer integral included, \
                   for the three fits of the gains.";
    Item { figures: vec![Figure::of_chart("figure-J.3", caption, &chart)], ..Item::default() }
}

/// The basins of Figure J.4.
pub(super) fn cases_j_4() -> Vec<Case> {
    all_fits(&[undelayed])
}

fn highest(outlines: &[Outline]) -> f64 {
    outlines.iter().flatten().map(|p| p.1).fold(0.0, f64::max)
}

/// Figure J.4: basins of the undelayed rider.
pub(super) fn figure_j_4(study: &Study) -> Item {
    let values = Item::compare("figure-J.4", |cell| merit(study, cell, &all_fits(&[undelayed]), &highest));
    let chart = outlines(study, "Basins of the undelayed rider", of_rider(study, "", 0, undelayed));
    let caption = "Outlines of the basins of the rider without neural delay.";
    Item { values, figures: vec![Figure::of_chart("figure-J.4", caption, &chart)], ..Item::default() }
}

fn late(delay_ms: u16) -> Case {
    Case::ridden(Cyclist::undelayed(Fit::Best, delay_ms))
}

/// The basins of Figure J.5.
pub(super) fn cases_j_5() -> Vec<Case> {
    [0, 30, 60].map(late).to_vec()
}

/// Figure J.5: the same gains with a delay that they were not identified with.
pub(super) fn figure_j_5(study: &Study) -> Item {
    let values = Item::compare("figure-J.5", |cell| merit(study, cell, &[late(60)], &|o| area(&o[0])));
    let one = |(i, delay): (usize, u16)| {
        let look = Look::line(i, super::fits::LINES[i]);
        outline(&format!("{delay} ms"), look, &study.basin(&late(delay)))
    };
    let series = [0, 30, 60].into_iter().enumerate().map(one).collect();
    let chart = outlines(study, "Basins with a delay the gains do not know of", series);
    let caption = "Outlines of the basins of the undelayed rider (LI highest VAF) when a neural delay is added and the \
                   gains stay.";
    Item { values, figures: vec![Figure::of_chart("figure-J.5", caption, &chart)], ..Item::default() }
}
