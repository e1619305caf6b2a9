//! Plots for a terminal: plain Unicode without colour.

mod braille;
mod columns;

use super::figure::scale::nice;
use super::figure::{BasinFigure, Curve, EigenFigure, RideFigure};
use crate::basin::{Axis, Basin};
use braille::Chart;

/// Smallest width of a plot with its numbers.
const MIN_WIDTH: usize = 40;

/// Plots basins, one below the other, as columns of blocks; every line ends with a newline.
pub fn basin(figure: &BasinFigure, width: usize) -> String {
    let rate = rate_label(figure.axis);
    let mut text = String::new();
    for (name, basin) in figure.series {
        let title = if name.is_empty() { rate.to_string() } else { format!("{name}: {rate}") };
        text += &columns::plot(basin, &title, columns::span(basin), width.max(MIN_WIDTH));
    }
    text
}

/// Plots a basin of which columns are still missing, over the speeds that it will cover \[m/s\].
pub fn partial_basin(basin: &Basin, axis: Axis, speeds: (f64, f64), width: usize) -> String {
    columns::plot(basin, rate_label(axis), columns::wide(speeds), width.max(MIN_WIDTH))
}

fn rate_label(axis: Axis) -> &'static str {
    match axis {
        Axis::SteerRate => "initial steer rate [rad/s]",
        Axis::RollRate => "initial roll rate [rad/s]",
    }
}

/// Plots roll, steer and torque over time.
pub fn ride(figure: &RideFigure, width: usize) -> String {
    let curves: [Curve; 3] = [
        ("roll [deg]", |p| p.roll.to_degrees()),
        ("steer [deg]", |p| p.steer.to_degrees()),
        ("torque of assist and rider [N m]", |p| p.torque + p.rider_torque),
    ];
    let x = (0.0, figure.end());
    let mut text = String::new();
    for (i, (label, of)) in curves.into_iter().enumerate() {
        let y = nice(figure.trace.iter().map(of), 3);
        let mut chart = Chart::new(width.max(MIN_WIDTH), 6, x, y);
        chart.line(figure.trace.iter().map(|p| (p.t, of(p))));
        text += &chart.text(label, (i + 1 == curves.len()).then_some("time [s]"));
    }
    text
}

/// Plots real parts of the roots over speed, imaginary parts below.
pub fn eigen(figure: &EigenFigure, width: usize) -> String {
    let width = width.max(MIN_WIDTH);
    let x = match figure.speeds {
        [first, .., last] if first < last => (*first, *last),
        [only, ..] => (only - 0.5, only + 0.5),
        [] => (0.0, 10.0),
    };
    let along = |root: &Vec<Option<_>>| {
        figure.speeds.iter().zip(root).filter_map(|(&v, e)| e.map(|e| (v, e))).collect::<Vec<_>>()
    };
    let points = || figure.modes.iter().flat_map(|mode| &mode.roots).flat_map(along);
    let mut real = Chart::new(width, 12, x, (-10.0, 10.0));
    real.dots(points().map(|(v, e)| (v, e.re)));
    let mut imaginary =
        Chart::new(width, 6, x, nice(points().map(|(_, e)| e.im.clamp(0.0, 20.0)).chain([1.0]), 3));
    imaginary.dots(points().filter(|(_, e)| e.im > 0.0).map(|(v, e)| (v, e.im)));
    real.text("Re λ [1/s]", None) + &imaginary.text("Im λ [rad/s]", Some("forward speed [m/s]"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basin::{Column, Island, ScanPoint, Work};
    use crate::eigen::{CriticalSpeeds, Mode};
    use crate::ride::{FallCause, Outcome};
    use nalgebra::Complex;

    fn fits(text: &str, width: usize) {
        assert!(text.ends_with('\n'));
        for line in text.lines() {
            assert!(line.chars().count() <= width, "{line}");
        }
    }

    fn column(speed: f64, upper: f64, capped: bool) -> Column {
        let outcome = |rate| match rate {
            r if r > upper => Outcome::Fallen { time_s: 1.0, by: FallCause::Roll },
            r if r < 2.0 => Outcome::Recovered,
            _ => Outcome::Undecided,
        };
        let scan = (1..=8).map(f64::from).map(|rate| ScanPoint { rate, outcome: outcome(rate) }).collect();
        let islands = if capped { vec![] } else { vec![Island { from: 6.0, to: 7.0 }] };
        Column {
            speed,
            upper,
            capped,
            islands,
            scan,
            outcome: None,
            border: None,
            beyond: None,
            work: Work::default(),
        }
    }

    fn basin_text(columns: Vec<Column>, width: usize) -> String {
        let basin = Basin { columns };
        let series = [("law", &basin)];
        let figure = BasinFigure {
            title: "",
            series: &series,
            self_stable: None,
            axis: Axis::SteerRate,
            cap: 8.0,
            band: None,
        };
        super::basin(&figure, width)
    }

    #[test]
    fn basins_of_any_shape_fit() {
        for columns in [
            vec![],
            vec![column(4.0, 3.0, false)],
            (0..5).map(|i| column(f64::from(i), 0.0, false)).collect(),
            (0..101).map(|i| column(0.1 * f64::from(i), 8.0, true)).collect(),
            (0..7).map(|i| column(f64::from(i), f64::from(i), false)).collect(),
        ] {
            for width in [0, 40, 80, 133] {
                fits(&basin_text(columns.clone(), width), width.max(MIN_WIDTH));
            }
        }
    }

    #[test]
    fn signs_differ_between_kinds() {
        let text = basin_text(vec![column(1.0, 5.0, false), column(2.0, 8.0, true)], 60);
        for sign in ["law: initial steer rate [rad/s]", "forward speed [m/s]", "▒ ", "▓ ", "▲ "] {
            assert!(text.contains(sign), "{sign}\n{text}");
        }
    }

    #[test]
    fn rides_and_eigenvalues_fit() {
        let outcome = Outcome::Fallen { time_s: 1.25, by: FallCause::Roll };
        let text = ride(&RideFigure { title: "", trace: &[], outcome }, 80);
        fits(&text, 80);
        assert!(text.contains("torque of assist and rider [N m]") && text.contains("time [s]"));
        let speeds: Vec<f64> = (0..11).map(f64::from).collect();
        let critical = CriticalSpeeds { v_d: None, v_w: Some(5.0), v_c: None };
        for n in [0, 1, 11] {
            let root = vec![Some(Complex::new(-3.0, 4.0)); n];
            let modes = [Mode { name: "weave".into(), roots: vec![root, vec![None; n]] }];
            let figure =
                EigenFigure { title: "", speeds: &speeds[..n], modes: &modes, stable: &[], critical };
            let text = eigen(&figure, 70);
            fits(&text, 70);
            assert!(text.contains("Re λ [1/s]") && text.contains("forward speed [m/s]"));
        }
    }
}
