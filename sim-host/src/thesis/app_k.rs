//! Appendix K: why the regression of the old cyclist's gains fails at 4.3 m/s, and the effect of every gain on the
//! torque.

use super::constant::{constant, disturbed, ridden};
use super::draw::over_time;
use super::item::{Figure, Item, Table, Value};
use super::study::Study;
use crate::eigen::{Feedback, Model, rightmost};
use crate::report::figure::{Axis, Chart, Line, Look, Marker, Plot, Series};
use crate::ride::{Conditions, Ride, TracePoint, traced};
use crate::rider::{Gains, KEYS, RiderTable, Row, catalogue, mean};
use control::Law;
use nalgebra::Complex;
use std::sync::Arc;

/// The speed at which the regression fails \[m/s\].
const SPEED: f64 = 4.3;
/// The disturbance of all rides \[rad/s\].
const DISTURBANCE: f64 = 0.5;
/// The delay of the old cyclist \[s\].
const DELAY_S: f64 = 0.06;
/// Time step of the rides \[s\], and the number of steps between drawn points. A finer one changes no printed number.
const STEP_S: f64 = 2e-3;
const EVERY: usize = 5;
const TIME: &str = "Time [s]";
const TORQUE: &str = "Rider's torque [N m]";
const LINES: [Line; 3] = [Line::Solid, Line::Dashed, Line::Dotted];

/// The old cyclist's measured gains.
fn smart() -> RiderTable {
    catalogue::load("smart").unwrap_or_else(|e| panic!("{e}"))
}

/// The rows of the group whose mean speed is closest to `speed` \[m/s\].
fn group(table: &RiderTable, speed: f64) -> &[Row] {
    let away = |rows: &&[Row]| (mean(rows).0 - speed).abs();
    table.groups().min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or_default()
}

/// The rightmost characteristic root \[1/s\] under constant gains.
fn root(study: &Study, gains: Gains, speed: f64) -> Complex<f64> {
    let rider = constant(gains, DELAY_S);
    rightmost(&Model::new(&study.parameters, Feedback::Law(Law::None), Some(rider)).at(speed))
}

fn ride(study: &Study, gains: Gains, speed: f64, seconds: f64) -> (Ride, Vec<TracePoint>) {
    let usual = ridden(study, constant(gains, DELAY_S));
    let conditions = Conditions { time_limit_s: seconds, step_s: STEP_S, ..usual };
    traced(&conditions, disturbed(speed, DISTURBANCE))
}

/// The rider's torque over time \[N m\].
fn torques(trace: &[TracePoint]) -> Vec<(f64, f64)> {
    over_time(trace, EVERY, |p| p.rider_torque)
}

/// Outcome of a ride, as text.
fn ended(ride: &Ride, trace: &[TracePoint]) -> String {
    match ride.outcome.time_to_fall_s() {
        Some(time) => format!("falls after {time:.2} s"),
        None => {
            let last = trace.last().map_or(0.0, |p| p.t) - 1.0;
            let torques = trace.iter().filter(|p| p.t > last).map(|p| p.rider_torque.abs());
            format!("stays up, last second within {:.2} N m", torques.fold(0.0, f64::max))
        }
    }
}

/// Table K.1: gains of the mean and of the regression.
pub(super) fn table_k_1(_: &Study) -> Item {
    let table = smart();
    let mean = mean(group(&table, SPEED)).1;
    let least = table.least_squares().at(SPEED);
    let equation = table.line().at(SPEED);
    let values = Item::compare("table-K.1", |cell| {
        let gain = |g: &Gains| g.get(&cell.column).unwrap_or(f64::NAN);
        let (m, lr, rounded) = (gain(&mean), gain(&least), gain(&equation));
        let percent = |of: f64, from: f64| 100.0 * (of - from) / from.abs();
        let row = cell.row.clone();
        match row.as_str() {
            "mean at 4.3 m/s" => Value::new(cell, Some(m)),
            "LR at 4.3 m/s" => Value::new(cell, Some(lr)).tried(EQUATION, rounded),
            _ => {
                let [pm, pl] = printed(&cell.column);
                let of_print = percent(pl, pm);
                Value::new(cell, Some(percent(lr, m)))
                    .tried(EQUATION, percent(rounded, m))
                    .tried("of the two printed rows", of_print)
                    .tried("of the two printed rows, a part of the signed mean, not percent", (pl - pm) / pm)
            }
        }
    });
    let note = "LR is the least-squares line over the rows of the table; it comes closer to what Table K.1 prints than \
                eq. G.2 with its rounded coefficients.";
    Item { values, notes: vec![note.into()], ..Item::default() }
}

const EQUATION: &str = "eq. G.2 as printed";

/// The printed mean and regression of a gain.
fn printed(key: &str) -> [f64; 2] {
    ["mean at 4.3 m/s", "LR at 4.3 m/s"].map(|row| {
        let cells = super::published::cells("table-K.1");
        let found = cells.into_iter().find(|c| c.row == row && c.column == key);
        found.and_then(|c| c.printed).map_or(f64::NAN, |p| p.value)
    })
}

/// Rides and characteristic roots of several sets of gains: a panel and a table.
fn compared(study: &Study, sets: &[(String, Gains)], seconds: f64) -> (Plot, Table) {
    let mut plot = Plot { x: Axis::new(TIME), y: Axis::new(TORQUE), ..Plot::default() };
    let mut rows = Vec::new();
    for (i, (name, gains)) in sets.iter().enumerate() {
        let (ride, trace) = ride(study, *gains, SPEED, seconds);
        plot.series.push(Series::new(name.clone(), Look::line(i, LINES[i / 6 % 3]), torques(&trace)));
        let root = root(study, *gains, SPEED);
        let turning = format!("{:.3}", root.im.abs());
        rows.push(vec![name.clone(), format!("{:+.3}", root.re), turning, ended(&ride, &trace)]);
    }
    let columns = ["gains", "Re of the rightmost root [1/s]", "Im [rad/s]", "ride"].map(String::from);
    let title = format!("Small motions and rides at {SPEED} m/s");
    (plot, Table { title, columns: columns.to_vec(), rows })
}

/// Symbol of a gain's signal: "δp/10" for `K_delta_p`.
fn short(key: &usize) -> String {
    let name = KEYS[*key].replace("K_", "").replace("phi_", "φ").replace("delta_", "δ");
    if name == "δp" { name + "/10" } else { name }
}

/// Figure K.1: the sets of gains at 4.3 m/s and their torques.
pub(super) fn figure_k_1(study: &Study) -> Item {
    let table = smart();
    let rows = group(&table, SPEED);
    let mut sets: Vec<(String, Gains)> =
        rows.iter().map(|r| (format!("run {}", r.run.unwrap_or(0)), r.gains)).collect();
    sets.push(("mean".into(), mean(rows).1));
    let regression = table.least_squares().at(SPEED);
    sets.push(("regression".into(), regression));
    let (torques, roots) = compared(study, &sets, 6.0);
    let markers = [Marker::Dot, Marker::Square, Marker::Triangle, Marker::Ring, Marker::Cross];
    let gains = |(i, (name, gains)): (usize, &(String, Gains))| {
        let points = table.columns.iter().enumerate().map(|(n, &key)| {
            let scale = if KEYS[key] == "K_delta_p" { 0.1 } else { 1.0 };
            ((n + 1) as f64, scale * gains.0[key])
        });
        let look = Look { marker: Some(markers[i % markers.len()]), ..Look::line(i, Line::None) };
        Series::new(format!("{name}: gains"), look, points.collect())
    };
    let left = Plot {
        x: Axis::of_names("Gain, by its signal", table.columns.iter().map(short).collect()),
        y: Axis::new("Gain"),
        series: sets.iter().enumerate().map(gains).collect(),
        ..Plot::default()
    };
    let chart = Chart {
        title: "Gains at 4.3 m/s and the torques they give".into(),
        columns: 2,
        plots: vec![left, torques],
        shaded: String::new(),
    };
    let (_, long) = ride(study, regression, SPEED, 60.0);
    let swing = |of: fn(&TracePoint) -> f64| {
        long.iter().filter(|p| p.t > 50.0).map(|p| of(p).abs()).fold(0.0, f64::max).to_degrees()
    };
    let (roll, steer) = (swing(|p| p.roll), swing(|p| p.steer));
    let end = long.last().map_or(0.0, |p| p.t);
    let note = format!(
        "The regression's small motions grow; ridden for 60 s its gains, held constant, still keep the bicycle up to \
         {end:.0} s, and it swings by {roll:.1} degrees of roll and {steer:.1} of steer in the last ten seconds: a limit cycle, not a fall."
    );
    let caption = "Left: the gains of the three runs at 4.3 m/s, their mean, and the regression; the proportional steer \
                   gain is divided by ten. Right: the rider's torque after a steer rate of 0.5 rad/s at 4.3 m/s, each \
                   set held constant, 60 ms of delay.";
    let figures = vec![Figure::of_chart("figure-K.1", caption, &chart)];
    Item { figures, tables: vec![roots], notes: vec![note], ..Item::default() }
}

/// Figure K.2: the regression with each gain in turn replaced by the mean's.
pub(super) fn figure_k_2(study: &Study) -> Item {
    let table = smart();
    let (regression, mean) = (table.least_squares().at(SPEED), mean(group(&table, SPEED)).1);
    let mut sets = vec![("regression".to_owned(), regression)];
    for &key in &table.columns {
        let mut gains = regression;
        gains.0[key] = mean.0[key];
        sets.push((format!("{} of the mean", KEYS[key]), gains));
    }
    let (torques, roots) = compared(study, &sets, 6.0);
    let chart = Chart {
        title: "The regression with single gains of the mean, 4.3 m/s".into(),
        columns: 1,
        plots: vec![torques],
        shaded: String::new(),
    };
    let stable: Vec<&str> = sets[1..]
        .iter()
        .filter(|(_, gains)| root(study, *gains, SPEED).re < 0.0)
        .map(|(name, _)| name.as_str())
        .collect();
    let note = format!(
        "Stable for small motions: {}. The thesis finds the roll acceleration's gain to stabilise completely and the \
         proportional steer gain to make it marginal.",
        if stable.is_empty() { "none".to_owned() } else { stable.join(", ") }
    );
    let caption = "The rider's torque after a steer rate of 0.5 rad/s at 4.3 m/s with the gains of the regression, and \
                   with one of them replaced by the mean's.";
    let figures = vec![Figure::of_chart("figure-K.2", caption, &chart)];
    Item { figures, tables: vec![roots], notes: vec![note], ..Item::default() }
}

/// The rider's torque over time \[N m\] after the disturbance, and the rightmost characteristic root \[1/s\].
#[derive(Debug)]
pub(super) struct Motion {
    torques: Vec<(f64, f64)>,
    root: Complex<f64>,
}

/// The motion under constant gains at `speed`, stored or computed now.
fn motion(study: &Study, gains: Gains, speed: f64) -> Arc<Motion> {
    study.motions.get((gains, speed), || {
        let (_, trace) = ride(study, gains, speed, 6.0);
        Motion { torques: torques(&trace), root: root(study, gains, speed) }
    })
}

/// The mean at one speed with every gain times 0.9, 1 and 1.1.
fn factors(study: &Study, name: &str, near: f64) -> Item {
    let table = smart();
    let rows = group(&table, near);
    let mean = mean(rows).1;
    let mut plots = Vec::new();
    let mut lines = Vec::new();
    for &key in &table.columns {
        let mut plot = Plot {
            title: KEYS[key].into(),
            x: Axis::new(TIME).over(0.0, 6.0),
            y: Axis::new(TORQUE),
            ..Plot::default()
        };
        let mut cells = vec![KEYS[key].to_owned(), format!("{:.3}", mean.0[key])];
        for (i, factor) in [0.9, 1.0, 1.1].into_iter().enumerate() {
            let mut gains = mean;
            gains.0[key] *= factor;
            let Motion { torques, root } = &*motion(study, gains, near);
            let name = format!("gain × {factor:.1}");
            plot.series.push(Series::new(name, Look::line(i, LINES[i]), torques.clone()));
            cells.push(format!("{:+.3} ± {:.3}i", root.re, root.im.abs()));
        }
        plots.push(plot);
        lines.push(cells);
    }
    let chart = Chart {
        title: format!("Single gains of the mean times 0.9, 1 and 1.1, {near} m/s"),
        columns: 2,
        plots,
        shaded: String::new(),
    };
    let caption = format!(
        "The rider's torque after a steer rate of 0.5 rad/s at {near} m/s with the mean gains of the group, one gain at \
         a time times 0.9, 1 and 1.1."
    );
    let columns = ["gain", "mean", "root × 0.9 [1/s]", "root × 1.0", "root × 1.1"].map(String::from);
    let title = format!("Rightmost characteristic roots at {near} m/s");
    let tables = vec![Table { title, columns: columns.to_vec(), rows: lines }];
    let figures = vec![Figure::of_chart(name, &caption, &chart)];
    Item { figures, tables, ..Item::default() }
}

/// Figure K.3: at 4.3 m/s.
pub(super) fn figure_k_3(study: &Study) -> Item {
    let note = "The caption of Figure K.3 prints the regression's gains as the mean's; the labels of Table K.1 are \
                right. Section K.1.3 calls the proportional steer gain negative; at 4.3 m/s it is positive, 45.12. \
                Figure K.6 shows the same again.";
    Item { notes: vec![note.into()], ..factors(study, "figure-K.3", SPEED) }
}

/// Figure K.4: at 2.2 m/s.
pub(super) fn figure_k_4(study: &Study) -> Item {
    factors(study, "figure-K.4", 2.2)
}

/// Figure K.5: at 3.2 m/s.
pub(super) fn figure_k_5(study: &Study) -> Item {
    factors(study, "figure-K.5", 3.2)
}

/// Figure K.6: at 4.3 m/s.
pub(super) fn figure_k_6(study: &Study) -> Item {
    factors(study, "figure-K.6", SPEED)
}

/// Figure K.7: at 6.0 m/s.
pub(super) fn figure_k_7(study: &Study) -> Item {
    factors(study, "figure-K.7", 6.0)
}

/// Figure K.8: at 7.3 m/s.
pub(super) fn figure_k_8(study: &Study) -> Item {
    factors(study, "figure-K.8", 7.3)
}
