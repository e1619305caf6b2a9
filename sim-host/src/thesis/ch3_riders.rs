//! Sections 3.1 to 3.3 and the end of 3.4: basins of the riders, without and with assist.

use super::case::{Assisted, Case, GRID};
use super::cyclist::{Cyclist, fit_name, fit_named, named};
use super::draw::{SELF_STABLE, SPEED, STEER_RATE, outline};
use super::figures_of_merit::{merit, with_readings};
use super::fits::LINES;
use super::heights::{Outline, area, mean, rmse};
use super::item::{Figure, Item, Value};
use super::published::Cell;
use super::study::Study;
use crate::basin::Basin;
use crate::report::figure::{Axis, Chart, Line, Look, Plot, Series};
use crate::rider::Fit;

type Who = fn(Fit) -> Cyclist;
/// The piecewise linear fits.
const INTERPOLATED: [Fit; 2] = [Fit::Mean, Fit::Best];

/// The basins of a rider by some fits.
pub(super) fn ridden(who: Who, fits: &[Fit]) -> Vec<Case> {
    fits.iter().map(|&fit| Case::ridden(who(fit))).collect()
}

/// The basins of riders by all fits.
pub(super) fn all_fits(riders: &[Who]) -> Vec<Case> {
    riders.iter().flat_map(|&who| ridden(who, &Fit::THESIS)).collect()
}

/// The basins of Table 3.1 and Figure 3.2.
pub(super) fn cases_3_1() -> Vec<Case> {
    with_readings(&all_fits(&[Cyclist::young]))
}

/// The basins of Table 3.2.
pub(super) fn cases_3_2() -> Vec<Case> {
    with_readings(&all_fits(&[Cyclist::smart, Cyclist::naive, Cyclist::young]))
}

/// The basins of Figure 3.2.
pub(super) fn cases_figure_3_2() -> Vec<Case> {
    all_fits(&[Cyclist::young])
}

/// The basins of Figure 3.4.
pub(super) fn cases_figure_3_4() -> Vec<Case> {
    all_fits(&[Cyclist::smart, Cyclist::naive])
}

/// A cell of a table of basins: area, mean height, and distances from the same rider's other fits.
pub(super) fn basin_cell(study: &Study, cell: Cell, rider: Cyclist) -> Value {
    let case = Case::ridden(rider);
    let other = cell.column.strip_prefix("RMSE to ").and_then(fit_named);
    match (cell.column.as_str(), other) {
        ("area", _) => merit(study, cell, &[case], &|o| area(&o[0])),
        ("mean height", _) => merit(study, cell, &[case], &|o| mean(&o[0])),
        (_, Some(fit)) if fit != rider.fit => {
            let other = Case::ridden(Cyclist { fit, ..rider });
            merit(study, cell, &[case, other], &|o| rmse(&o[0], &o[1]))
        }
        _ => Value::new(cell, None),
    }
}

fn mean_area(outlines: &[Outline]) -> f64 {
    outlines.iter().map(|o| area(o)).sum::<f64>() / outlines.len() as f64
}

fn mean_height(outlines: &[Outline]) -> f64 {
    outlines.iter().map(|o| mean(o)).sum::<f64>() / outlines.len() as f64
}

/// Decrease of the areas from the first half to the second half \[%\].
fn decline(outlines: &[Outline]) -> f64 {
    let (before, after) = outlines.split_at(outlines.len() / 2);
    100.0 * (1.0 - mean_area(after) / mean_area(before))
}

/// Table 3.1.
pub(super) fn table_3_1(study: &Study) -> Item {
    let values = Item::compare("table-3.1", |cell| match (named(&cell.row), cell.column.as_str()) {
        (Some(rider), _) => basin_cell(study, cell, rider),
        (None, "area") => merit(study, cell, &ridden(Cyclist::young, &Fit::THESIS), &mean_area),
        (None, _) => merit(study, cell, &ridden(Cyclist::young, &Fit::THESIS), &mean_height),
    });
    Item { values, ..Item::default() }
}

/// Table 3.2.
pub(super) fn table_3_2(study: &Study) -> Item {
    let values = Item::compare("table-3.2", |cell| match (named(&cell.row), cell.column.as_str()) {
        (Some(rider), _) => basin_cell(study, cell, rider),
        (None, "area") => merit(study, cell, &ridden(Cyclist::smart, &INTERPOLATED), &mean_area),
        (None, "mean height") => merit(study, cell, &ridden(Cyclist::smart, &INTERPOLATED), &mean_height),
        (None, _) => merit(study, cell, &all_fits(&[Cyclist::young, Cyclist::naive]), &decline),
    });
    Item { values, ..Item::default() }
}

/// The basins of Table 3.3.
pub(super) fn cases_3_3() -> Vec<Case> {
    let whos: [Who; 3] = [Cyclist::young, Cyclist::naive, Cyclist::smart];
    with_readings(&whos.into_iter().flat_map(|who| ridden(who, &INTERPOLATED)).collect::<Vec<_>>())
}

/// Table 3.3.
pub(super) fn table_3_3(study: &Study) -> Item {
    let values = Item::compare("table-3.3", |cell| {
        let fits = fit_named(&cell.row).map_or(INTERPOLATED.to_vec(), |fit| vec![fit]);
        let of = |who: Who| ridden(who, &fits);
        let from_young = |who: Who| [of(Cyclist::young), of(who)].concat();
        match cell.column.as_str() {
            "young" => merit(study, cell, &of(Cyclist::young), &mean_area),
            "naive" => merit(study, cell, &of(Cyclist::naive), &mean_area),
            "smart" => merit(study, cell, &of(Cyclist::smart), &mean_area),
            "decline, naive" => merit(study, cell, &from_young(Cyclist::naive), &decline),
            _ => merit(study, cell, &from_young(Cyclist::smart), &decline),
        }
    });
    Item { values, ..Item::default() }
}

/// A panel of outlines over the speeds at which the riders were measured, marked by vertical lines.
pub(super) fn outlines(study: &Study, title: &str, series: Vec<Series>) -> Chart {
    let speeds = Cyclist::young(Fit::Mean).schedule().points().iter().map(|p| p.0).collect();
    let stable = study.self_stable().map(|(from, to)| (from, to.min(7.5)));
    let plot = Plot {
        x: Axis::new(SPEED).over(2.0, 7.5),
        y: Axis::new(STEER_RATE),
        series,
        shaded: stable.into_iter().collect(),
        verticals: speeds,
        ..Plot::default()
    };
    Chart { title: title.into(), columns: 1, plots: vec![plot], shaded: SELF_STABLE.into() }
}

/// The outlines of a rider by every fit, in one colour.
pub(super) fn of_rider(study: &Study, name: &str, colour: usize, who: Who) -> Vec<Series> {
    let one = |(fit, line): (Fit, Line)| {
        let basin = study.basin(&Case::ridden(who(fit)));
        outline(format!("{name} {}", fit_name(fit)).trim(), Look::line(colour, line), &basin)
    };
    Fit::THESIS.into_iter().zip(LINES).map(one).collect()
}

const VERTICALS: &str = "The vertical lines are the speeds the gains were measured at.";

/// Figure 3.2.
pub(super) fn figure_3_2(study: &Study) -> Item {
    let chart = outlines(study, "Basins of the young cyclist", of_rider(study, "", 0, Cyclist::young));
    let caption =
        format!("Outlines of the basins of the young cyclist, 30 ms late, without assist. {VERTICALS}");
    Item { figures: vec![Figure::of_chart("figure-3.2", &caption, &chart)], ..Item::default() }
}

/// Figure 3.4.
pub(super) fn figure_3_4(study: &Study) -> Item {
    let smart = of_rider(study, "smart", 0, Cyclist::smart);
    let naive = of_rider(study, "naive", 1, Cyclist::naive);
    let chart = outlines(study, "Basins of the old cyclists", [smart, naive].concat());
    let caption = format!(
        "Outlines of the basins of the old cyclists, 60 ms late, without assist: the smart one, whose gains know of \
         the delay, and the naive one with the young cyclist's gains. {VERTICALS}"
    );
    Item { figures: vec![Figure::of_chart("figure-3.4", &caption, &chart)], ..Item::default() }
}

/// The riders of Figure 3.5.
const THREE: [(&str, Who); 3] =
    [("young", Cyclist::young), ("smart", Cyclist::smart), ("naive", Cyclist::naive)];

/// The basins of Figure 3.5.
pub(super) fn cases_3_5() -> Vec<Case> {
    THREE.into_iter().map(|(_, who)| Case::ridden(who(Fit::Mean)).mapped()).collect()
}

/// The longest time to fall \[s\] at disturbances that are multiples of `step` \[rad/s\].
fn longest_fall(basin: &Basin, step: f64) -> Option<f64> {
    let on_grid = |rate: f64| ((rate / step).round() * step - rate).abs() < 1e-9;
    let scan = basin.columns.iter().flat_map(|c| &c.scan).filter(|p| on_grid(p.rate));
    scan.filter_map(|p| p.outcome.time_to_fall_s()).reduce(f64::max)
}

/// Figure 3.5.
pub(super) fn figure_3_5(study: &Study) -> Item {
    let of = |who: Who| study.basin(&Case::ridden(who(Fit::Mean)).mapped());
    let filled = THREE
        .into_iter()
        .enumerate()
        .map(|(i, (name, who))| outline(name, Look::line([2, 0, 1][i], Line::Filled), &of(who)));
    let chart = outlines(study, "Basins of the three cyclists", filled.collect());
    let caption = "Basins of the young cyclist (30 ms), the smart, old one and the naive, old one (60 ms), gains by \
                   straight lines through the means of the groups.";
    let mut figures = vec![Figure::of_chart("figure-3.5", caption, &chart)];
    for (name, who) in THREE {
        let caption = format!(
            "Basin of the {name} cyclist. Inside: rides of 6 s that do not fall; outside, the colour shows the time \
             to the fall."
        );
        figures.push(Figure::of_basins(&format!("figure-3.5-{name}"), &caption, study, &[(name, &of(who))]));
    }
    let values = Item::compare("figure-3.5", |cell| {
        let who = THREE.into_iter().find(|(name, _)| *name == cell.row).map(|(_, who)| who);
        let longest = |step| longest_fall(&of(who?), step);
        Value::new(cell, longest(study.resolution.scan_step)).on_grid(longest(GRID))
    });
    let note = "The longest time is that of single rides close to the border: the closer to it, the longer.";
    Item { values, figures, notes: vec![note.into()], ..Item::default() }
}

fn aided(fit: Fit) -> Case {
    Case::ridden(Cyclist::smart(fit)).aided(Assisted::H)
}

/// The basins of Figure 3.15.
pub(super) fn cases_3_15() -> Vec<Case> {
    let riders = INTERPOLATED.iter().flat_map(|&fit| [Case::ridden(Cyclist::smart(fit)), aided(fit)]);
    let alone = [Case::of(Assisted::H), Case::of(Assisted::Alone)];
    with_readings(&riders.collect::<Vec<_>>()).into_iter().chain(alone).collect()
}

/// Figure 3.15.
pub(super) fn figure_3_15(study: &Study) -> Item {
    let values = Item::compare("figure-3.15", |cell| {
        let cases = |fit| [Case::ridden(Cyclist::smart(fit)), aided(fit)];
        let ratio = |o: &[Outline]| 100.0 * area(&o[1]) / area(&o[0]);
        let best = merit(study, cell.clone(), &cases(Fit::Best), &ratio);
        let mut value = merit(study, cell, &cases(Fit::Mean), &ratio);
        value.experiments.iter_mut().for_each(|e| e.name = format!("LI mean, {}", e.name));
        value = value.tried("LI highest VAF", best.exact.unwrap_or(f64::NAN));
        value = value.tried("LI highest VAF; steps of 0.5 rad/s", best.coarse.unwrap_or(f64::NAN));
        best.experiments
            .iter()
            .fold(value, |value, e| value.tried(&format!("LI highest VAF, {}", e.name), e.value))
    });
    let alone =
        outline("uncontrolled", Look::line(4, Line::Filled), &study.basin(&Case::of(Assisted::Alone)));
    let assist = outline("h alone", Look::line(2, Line::Solid), &study.basin(&Case::of(Assisted::H)));
    let mut series = vec![inside(alone), inside(assist)];
    for (fit, line) in INTERPOLATED.into_iter().zip([Line::Dashed, Line::Dotted]) {
        let basin = |case: Case| study.basin(&case);
        let name = |who: &str| format!("{who} {}", fit_name(fit));
        series.push(outline(&name("smart"), Look::line(0, line), &basin(Case::ridden(Cyclist::smart(fit)))));
        series.push(outline(&name("smart and h"), Look::line(1, line), &basin(aided(fit))));
    }
    let chart = outlines(study, "Basins of the smart, old cyclist aided by h", series);
    let caption = format!(
        "Outlines of the basins of the smart, old cyclist alone, of law h alone, and of both in parallel. {VERTICALS}"
    );
    let note = "The thesis does not say which of the two interpolations grew by how much; the means are compared, the \
                best sets are among the readings.";
    let figures = vec![Figure::of_chart("figure-3.15", &caption, &chart)];
    Item { values, figures, notes: vec![note.into()], ..Item::default() }
}

/// The part of a series at the speeds at which riders were measured.
fn inside(series: Series) -> Series {
    let points = super::heights::between(&series.points, 2.0, 7.5);
    Series { points, ..series }
}
