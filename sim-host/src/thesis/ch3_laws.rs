//! Section 3.4: gains and eigenvalues of the steer assist's laws.

use super::case::Assisted;
use super::draw::{SELF_STABLE, SPEED, eigen_lines, eigen_plot, gain_line, same_name, speeds};
use super::item::{Figure, Item, Value};
use super::study::Study;
use crate::eigen::{critical_speeds, eigenvalues};
use crate::report::figure::{Axis, Chart, Line, Look, Marker, Plot, Series};

const LINES: [Line; 4] = [Line::Solid, Line::Dashed, Line::Dotted, Line::Solid];
const GAIN: &str = "Gain on roll rate [N m s/rad]";
/// The laws with K from 1 to 4.
pub(super) const CL2: [Assisted; 4] =
    [Assisted::Cl2(1), Assisted::Cl2(2), Assisted::Cl2(3), Assisted::Cl2(4)];
/// The nonlinear laws.
pub(super) const CL3: [Assisted; 3] = [Assisted::F, Assisted::G, Assisted::H];
/// The black crosses of Figures 3.10 and 3.11: K and speed \[m/s\] (eqs 3.8 to 3.10).
pub(super) const CROSSES: [(u8, f64); 3] = [(3, 1.4), (2, 2.8), (1, 4.4)];

/// The name of a cross in `data/thesis.toml`.
pub(super) fn cross_name((k, speed): (u8, f64)) -> String {
    format!("CL2, K = {k} at {speed} m/s")
}

fn weave_speed(study: &Study, law: Assisted) -> Option<f64> {
    critical_speeds(&study.linear, &law.law()).v_w
}

/// Section 3.4: weave speeds under every law.
pub(super) fn section_3_4(study: &Study) -> Item {
    let of = |law| weave_speed(study, law);
    let nonlinear = || CL3.into_iter().filter_map(of);
    let values = Item::compare("section-3.4", |cell| {
        let speed = match cell.row.as_str() {
            "CL1" => of(Assisted::Cl1),
            "f" => of(Assisted::F),
            "g" => of(Assisted::G),
            "h" => of(Assisted::H),
            "lowest of f, g, h" => nonlinear().reduce(f64::min),
            "highest of f, g, h" => nonlinear().reduce(f64::max),
            name => CL2.into_iter().find(|law| law.name() == name).and_then(of),
        };
        Value::new(cell, speed)
    });
    Item { values, ..Item::default() }
}

/// Figure 3.6: eigenvalues and gain of CL1.
pub(super) fn figure_3_6(study: &Study) -> Item {
    let mut eigen = eigen_plot(study, Assisted::Cl1, 10.0);
    eigen.verticals.push(6.7);
    eigen.shaded.extend(weave_speed(study, Assisted::Cl1).map(|v| (v, 10.0)));
    let gains = Plot {
        x: Axis::new(SPEED),
        y: Axis::new(GAIN),
        series: vec![Series::new(
            "gain",
            Look::line(2, Line::Solid),
            gain_line(Assisted::Cl1, &speeds(10.0, 200)),
        )],
        verticals: vec![6.7],
        ..Plot::default()
    };
    let title = "CL1: eigenvalues and gain".to_owned();
    let chart = Chart { title, columns: 2, plots: vec![eigen, gains], shaded: "stable under CL1".into() };
    let (from, to) = two_pairs(study, Assisted::Cl1).unzip();
    let decrease =
        study.critical.v_w.zip(weave_speed(study, Assisted::Cl1)).map(|(v, w)| 100.0 * (v - w) / v);
    let values = Item::compare("figure-3.6", |cell| {
        let exact = match cell.column.as_str() {
            "two complex pairs from" => from,
            "two complex pairs to" => to,
            _ => decrease,
        };
        Value::new(cell, exact)
    });
    let caption = "Eigenvalues of the linearised bicycle under CL1, 5.97 (6.7 - v) on the roll rate below 6.7 m/s, and \
                   the gain. Positive gains steer into the fall; the thesis prints them with the other sign.";
    Item { values, figures: vec![Figure::of_chart("figure-3.6", caption, &chart)], ..Item::default() }
}

/// The first range of speeds with two complex pairs \[m/s\]; each end by bisection.
fn two_pairs(study: &Study, law: Assisted) -> Option<(f64, f64)> {
    let law = law.law();
    let both = |v: f64| eigenvalues(&study.linear, &law, v).iter().all(|e| e.im != 0.0);
    let grid = speeds(10.0, 2000);
    let first = grid.iter().position(|&v| both(v))?;
    let end = (first..grid.len()).find(|&i| !both(grid[i]))?;
    let border = |mut inside: f64, mut outside: f64| {
        for _ in 0..60 {
            let middle = 0.5 * (inside + outside);
            if both(middle) { inside = middle } else { outside = middle }
        }
        inside
    };
    Some((border(grid[first], grid[first.saturating_sub(1)]), border(grid[end - 1], grid[end])))
}

/// Figure 3.9: eigenvalues and gains of CL2.
pub(super) fn figure_3_9(study: &Study) -> Item {
    let chart = several(study, "CL2: eigenvalues and gains", &CL2);
    let caption = "Imaginary and real parts of the eigenvalues under CL2, K (10 - v) on the roll rate, and the gains. \
                   The vertical lines are the weave speeds.";
    Item { figures: vec![Figure::of_chart("figure-3.9", caption, &chart)], ..Item::default() }
}

/// Figure 3.12: eigenvalues of f, g and h.
pub(super) fn figure_3_12(study: &Study) -> Item {
    let plot = |law: Assisted| {
        let mut plot = eigen_plot(study, law, 10.0);
        plot.title = format!("law {}", law.name());
        plot.shaded.extend(weave_speed(study, law).map(|v| (v, 10.0)));
        plot
    };
    let chart = Chart {
        title: "CL3: eigenvalues under f, g and h".into(),
        columns: 2,
        plots: CL3.map(plot).to_vec(),
        shaded: "stable under the law".into(),
    };
    let caption = "Eigenvalues of the linearised bicycle under the nonlinear laws of eqs 3.11 to 3.13.";
    Item { figures: vec![Figure::of_chart("figure-3.12", caption, &chart)], ..Item::default() }
}

/// Imaginary parts, real parts and gains of several laws.
fn several(study: &Study, title: &str, laws: &[Assisted]) -> Chart {
    let grid = speeds(10.0, 1000);
    let mut imaginary =
        Plot { x: Axis::new(SPEED), y: Axis::new("Im λ [rad/s]").over(0.0, 12.0), ..Plot::default() };
    let mut real = Plot { y: Axis::new("Re λ [1/s]").over(-10.0, 10.0), ..imaginary.clone() };
    let mut gains = Plot { y: Axis::new(GAIN), ..imaginary.clone() };
    for (i, &law) in laws.iter().enumerate() {
        let (name, look) = (law.name(), Look::line(i, LINES[i % LINES.len()]));
        let lines = eigen_lines(study, law, &grid);
        imaginary.series.extend(same_name(&name, look, lines.imaginary));
        real.series.extend(same_name(&name, look, lines.real));
        gains.series.push(Series::new(name, look, gain_line(law, &grid)));
        real.verticals.extend(weave_speed(study, law));
    }
    Chart { title: title.into(), columns: 2, plots: vec![imaginary, real, gains], shaded: String::new() }
}

/// Figure 3.11: the gains of the nonlinear laws.
pub(super) fn figure_3_11(_: &Study) -> Item {
    let grid = speeds(10.0, 200);
    let faint =
        CL2[..3].iter().map(|&law| Series::new("", Look::line(4, Line::Faint), gain_line(law, &grid)));
    let laws = CL3
        .iter()
        .enumerate()
        .map(|(i, &law)| Series::new(law.name(), Look::line(i, LINES[i]), gain_line(law, &grid)));
    let gain_at = |(k, v): (u8, f64)| Assisted::Cl2(k).law().gain(v);
    let crosses = CROSSES.iter().map(|&cross| (cross.1, gain_at(cross))).collect();
    let crosses = Series::new("wanted: eqs 3.8 to 3.10", Look::marks(4, Marker::Cross), crosses);
    let plot = Plot {
        x: Axis::new(SPEED),
        y: Axis::new(GAIN),
        series: faint.chain(laws).chain([crosses]).collect(),
        ..Plot::default()
    };
    let title = "CL3: gains of f, g and h".to_owned();
    let chart = Chart { title, columns: 1, plots: vec![plot], shaded: String::new() };
    let values = Item::compare("figure-3.11", |cell| {
        let cross = CROSSES.into_iter().find(|&c| cross_name(c) == cell.row);
        Value::new(cell, cross.map(gain_at))
    });
    let caption = "Gains of the nonlinear laws over speed, positive into the fall. Thin grey lines: CL2 with K = 1, 2 \
                   and 3, on which the crosses lie.";
    let figures = vec![Figure::of_chart("figure-3.11", caption, &chart)];
    let note = format!("{SELF_STABLE}: see Figure 2.2. Above 7.5 m/s the gain of h steers out of the fall.");
    Item { values, figures, notes: vec![note], ..Item::default() }
}
