//! Beyond appendix K: sensitivity of the height of the old cyclist's basin to all parameters.

use super::constant::ridden;
use super::item::{Figure, Item, Table};
use super::study::Study;
use crate::basin::{Quantity, Sensitivity, sensitivities};
use crate::report::figure::{Axis, Chart, Look, Marker, Plot, Series};
use crate::rider::{Fit, Outside, Rider, catalogue};
use std::fmt::Write;

/// The speeds of the measured groups \[m/s\].
const SPEEDS: [f64; 5] = [2.2, 3.2, 4.3, 6.0, 7.3];
/// Number of quantities in the figure at each speed.
const SHOWN: usize = 10;

fn smart() -> Rider {
    let table = catalogue::load("smart").unwrap_or_else(|e| panic!("{e}"));
    table.rider(Fit::Mean, Outside::Extrapolate, None).unwrap_or_else(|e| panic!("{e}"))
}

/// The sensitivities at the measured speeds: a figure, a table, and the positions where the height is not smooth.
pub(super) fn sensitivity_k(study: &Study) -> Item {
    let rider = smart();
    let quantities = Quantity::all(&rider);
    let conditions = ridden(study, rider);
    let speeds = if study.quick { &SPEEDS[2..3] } else { &SPEEDS[..] };
    let tolerance = if study.quick { 3e-4 } else { 1e-4 };
    let mut all: Vec<Vec<Sensitivity>> = Vec::new();
    for &speed in speeds {
        match sensitivities(&conditions, &study.parameters, &quantities, speed, tolerance) {
            Ok(found) => all.push(found),
            Err(e) => return Item { notes: vec![e.to_string()], ..Item::default() },
        }
    }
    let chart = Chart {
        title: "Elasticity of the basin's height, the old cyclist".into(),
        columns: 2,
        plots: all.iter().map(|at| panel(at)).collect(),
        shaded: String::new(),
    };
    let caption = format!(
        "Elasticity of the height of the basin at each measured speed, in % of the height for 1 % of the quantity: the \
         {SHOWN} largest. Gains are changed at all speeds; LI mean, 60 ms."
    );
    let figure = Figure { csv: csv(&all), ..Figure::of_chart("sensitivity-K", &caption, &chart) };
    Item { figures: vec![figure], tables: vec![table(&all)], notes: notes(&all), ..Item::default() }
}

/// The largest elasticities at a speed.
fn panel(at: &[Sensitivity]) -> Plot {
    let mut sorted: Vec<&Sensitivity> = at.iter().collect();
    sorted.sort_by(|a, b| b.elasticity().abs().total_cmp(&a.elasticity().abs()));
    sorted.truncate(SHOWN);
    // The largest is drawn on top.
    sorted.reverse();
    let names = sorted.iter().map(|s| s.quantity.name().to_owned()).collect();
    let mut plot = Plot {
        title: format!("{} m/s, height {:.2} rad/s", at[0].speed, at[0].height),
        x: Axis::new("Elasticity"),
        y: Axis::of_names("", names),
        verticals: vec![0.0],
        ..Plot::default()
    };
    for (name, colour, marker, smooth) in
        [("both steps agree", 0, Marker::Dot, true), ("they do not", 1, Marker::Cross, false)]
    {
        let points = sorted.iter().enumerate().filter(|(_, s)| s.is_smooth() == smooth);
        let points = points.map(|(i, s)| (s.elasticity(), (i + 1) as f64)).collect();
        plot.series.push(Series::new(name, Look::marks(colour, marker), points));
    }
    plot
}

fn csv(all: &[Vec<Sensitivity>]) -> String {
    let mut text = String::from(
        "speed_m_s,quantity,height_rad_s,change_rad_s_per_percent,half_step_rad_s_per_percent,elasticity,smooth\n",
    );
    for s in all.iter().flatten() {
        let (name, smooth) = (s.quantity.name(), s.is_smooth());
        let _ = writeln!(
            text,
            "{},{name},{},{},{},{},{smooth}",
            s.speed,
            s.height,
            s.per_percent,
            s.halved,
            s.elasticity()
        );
    }
    text
}

/// Change per percent and elasticity, one row per quantity, sorted by the largest value at any speed.
fn table(all: &[Vec<Sensitivity>]) -> Table {
    let mut order: Vec<usize> = (0..all.first().map_or(0, Vec::len)).collect();
    let largest = |i: &usize| all.iter().map(|at| at[*i].elasticity().abs()).fold(0.0, f64::max);
    order.sort_by(|a, b| largest(b).total_cmp(&largest(a)));
    let mut columns = vec!["quantity".to_owned()];
    for at in all {
        let speed = at[0].speed;
        columns.push(format!("{speed} m/s: rad/s per +1 %"));
        columns.push(format!("{speed} m/s: elasticity"));
    }
    let cells = |i: usize| {
        let each = all.iter().flat_map(move |at| {
            let rough = if at[i].is_smooth() { "" } else { "*" };
            [format!("{:+.4}{rough}", at[i].per_percent), format!("{:+.2}{rough}", at[i].elasticity())]
        });
        std::iter::once(all[0][i].quantity.name().to_owned()).chain(each).collect()
    };
    Table {
        title: "Sensitivity of the basin's height; * where half the step gives another answer".into(),
        columns,
        rows: order.into_iter().map(cells).collect(),
    }
}

fn notes(all: &[Vec<Sensitivity>]) -> Vec<String> {
    let rough = all.iter().flatten().filter(|s| !s.is_smooth());
    let rough: Vec<String> = rough.map(|s| format!("{} at {} m/s", s.quantity.name(), s.speed)).collect();
    let first = "Central differences of 1 % (of the delay 2 ms), each checked with half the step.".to_owned();
    let second = if rough.is_empty() {
        "Both steps agree everywhere.".to_owned()
    } else {
        format!("They differ by more than a tenth, the height is not smooth there: {}.", rough.join(", "))
    };
    vec![first, second]
}
