//! Elements common to the figures of several chapters.

use super::case::Assisted;
use super::item::Figure;
use super::study::Study;
use crate::basin::{Axis as Disturbed, Basin};
use crate::eigen::eigenvalues;
use crate::report::figure::{self, Axis, BasinFigure, Chart, Line, Look, Plot, Series, chart};
use crate::report::table::{basin_rows, csv_text};
use crate::ride::TracePoint;
use std::fmt::Write;

/// The label of forward speed.
pub(super) const SPEED: &str = "Forward speed v [m/s]";
/// The label of the disturbance.
pub(super) const STEER_RATE: &str = "Initial steer rate [rad/s]";
/// Meaning of the shaded range.
pub(super) const SELF_STABLE: &str = "uncontrolled bicycle self-stable";

impl Figure {
    /// A chart and its points as a table: panel, series, x, y.
    pub(super) fn of_chart(name: &str, caption: &str, drawn: &Chart) -> Self {
        let mut csv = String::from("panel,series,x,y\n");
        for (i, plot) in drawn.plots.iter().enumerate() {
            let panel = if plot.title.is_empty() { (i + 1).to_string() } else { plot.title.clone() };
            let panel = quoted(&format!("{panel}: {} over {}", plot.y.label, plot.x.label));
            for series in &plot.series {
                for (x, y) in series.points.iter().filter(|(_, y)| y.is_finite()) {
                    let _ = writeln!(csv, "{panel},{},{x},{y}", quoted(&series.name));
                }
            }
        }
        Self { name: name.into(), caption: caption.into(), picture: chart(drawn), csv }
    }

    /// One basin with its inside and outside, or the outlines of several.
    pub(super) fn of_basins(name: &str, caption: &str, study: &Study, series: &[(&str, &Basin)]) -> Self {
        let cap = series.iter().flat_map(|(_, b)| &b.columns).flat_map(|c| &c.scan).map(|p| p.rate);
        let title = caption.split(". ").next().unwrap_or_default();
        let drawn = BasinFigure {
            band: None,
            title,
            series,
            self_stable: study.self_stable(),
            axis: Disturbed::SteerRate,
            cap: cap.fold(0.0, f64::max),
        };
        let mut csv = String::from("basin,speed_m_s,rate_rad_s,outcome,time_to_fall_s,fall,capped\n");
        for (label, basin) in series {
            for line in csv_text(&basin_rows(basin)).unwrap_or_default().lines().skip(1) {
                let _ = writeln!(csv, "{},{line}", quoted(label));
            }
        }
        Self { name: name.into(), caption: caption.into(), picture: figure::basin(&drawn), csv }
    }
}

/// A field of a CSV table.
pub(super) fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.into() }
}

/// `n` + 1 speeds from 0 to `to` \[m/s\].
pub(super) fn speeds(to: f64, n: u32) -> Vec<f64> {
    (0..=n).map(|i| to * f64::from(i) / f64::from(n)).collect()
}

/// Real and imaginary parts over speed as lines.
///
/// The k-th largest real part is continuous over speed, and so is the k-th largest imaginary part, so modes need not be
/// followed from speed to speed.
pub(super) struct EigenLines {
    /// The largest, second largest... real part \[1/s\].
    pub(super) real: Vec<Vec<(f64, f64)>>,
    /// The larger and the smaller positive imaginary part \[rad/s\]; NaN where there is no pair.
    pub(super) imaginary: Vec<Vec<(f64, f64)>>,
}

/// The eigenvalues under a law.
pub(super) fn eigen_lines(study: &Study, law: Assisted, speeds: &[f64]) -> EigenLines {
    let law = law.law();
    sorted_lines(speeds, |v| eigenvalues(&study.linear, &law, v).map(|e| (e.re, e.im)).to_vec())
}

/// Lines of any eigenvalues, given as `(real, imaginary)` pairs, equally many at every speed.
pub(super) fn sorted_lines(speeds: &[f64], at: impl Fn(f64) -> Vec<(f64, f64)>) -> EigenLines {
    let all: Vec<Vec<(f64, f64)>> = speeds.iter().map(|&v| at(v)).collect();
    let n = all.first().map_or(0, Vec::len);
    let growth = all.iter().map(|values| values.iter().map(|e| e.0).collect()).collect();
    let turning = |values: &Vec<(f64, f64)>| {
        let mut parts: Vec<f64> = values.iter().map(|e| e.1).filter(|im| *im > 1e-9).collect();
        parts.resize(n, f64::NEG_INFINITY);
        parts
    };
    let mut imaginary = by_size(speeds, all.iter().map(turning).collect(), n / 2);
    for point in imaginary.iter_mut().flatten().filter(|p| p.1.is_infinite()) {
        point.1 = f64::NAN;
    }
    EigenLines { real: by_size(speeds, growth, n), imaginary }
}

/// Lines through the largest, second largest... of `values` at every speed; `count` lines.
fn by_size(speeds: &[f64], mut values: Vec<Vec<f64>>, count: usize) -> Vec<Vec<(f64, f64)>> {
    values.iter_mut().for_each(|v| v.sort_by(|a, b| b.total_cmp(a)));
    (0..count).map(|k| speeds.iter().zip(&values).map(|(&v, sorted)| (v, sorted[k])).collect()).collect()
}

/// The lines as series with the same name.
pub(super) fn same_name(name: &str, look: Look, lines: Vec<Vec<(f64, f64)>>) -> Vec<Series> {
    lines.into_iter().map(|points| Series::new(name, look, points)).collect()
}

/// Real parts solid and imaginary parts dashed in one panel, from -10 to 10.
pub(super) fn eigen_plot(study: &Study, law: Assisted, to: f64) -> Plot {
    let lines = eigen_lines(study, law, &speeds(to, 1000));
    let real = same_name("real part [1/s]", Look::line(0, Line::Solid), lines.real);
    let imaginary = same_name("imaginary part [rad/s]", Look::line(1, Line::Dashed), lines.imaginary);
    Plot {
        title: String::new(),
        x: Axis::new(SPEED).over(0.0, to),
        y: Axis::new("Eigenvalue λ").over(-10.0, 10.0),
        series: [real, imaginary].concat(),
        ..Plot::default()
    }
}

/// The gain of a law over speed \[N m s/rad\].
pub(super) fn gain_line(law: Assisted, speeds: &[f64]) -> Vec<(f64, f64)> {
    let law = law.law();
    speeds.iter().map(|&v| (v, law.gain(v))).collect()
}

/// A signal of a ride over time, every `every`th point and the last.
pub(super) fn over_time(
    trace: &[TracePoint],
    every: usize,
    of: impl Fn(&TracePoint) -> f64,
) -> Vec<(f64, f64)> {
    let last = trace.len().saturating_sub(1);
    let selected = trace.iter().enumerate().filter(|(i, _)| i.is_multiple_of(every.max(1)) || *i == last);
    selected.map(|(_, p)| (p.t, of(p))).collect()
}

/// An outline as a series.
pub(super) fn outline(name: &str, look: Look, basin: &Basin) -> Series {
    Series::new(name, look, basin.columns.iter().map(|c| (c.speed, c.upper)).collect())
}
