//! Appendix C: eigenvalues estimated from nonlinear responses, by the thesis's methods and by the matrix pencil.

use super::case::Assisted;
use super::draw::{SPEED, eigen_lines, same_name, speeds};
use super::item::{Figure, Item, Table};
use super::study::Study;
use crate::damped::{Bounds, Fitted, bounded, decay, oscillation};
use crate::eigen::eigenvalues;
use crate::matrix_pencil;
use crate::report::figure::{Axis, Chart, Line, Look, Marker, Plot, Series};
use crate::ride::{Assist, Conditions, Start, TracePoint, traced};
use control::Law;
use nalgebra::{Complex, ComplexField};
use rayon::prelude::*;

/// The thesis's disturbance \[rad/s\].
const DISTURBANCE: f64 = 0.1;
/// A disturbance at which the bicycle is practically linear \[rad/s\].
pub const TINY: f64 = 1e-6;
/// Control periods between samples of the fits.
const EVERY: usize = 10;
/// The initial part of the steer rate that attempt 2 omits \[s\]; the thesis says "the first part".
const LEFT_OUT_S: f64 = 0.5;
/// Speed from which attempt 3 fits a capsize mode \[m/s\].
const CAPSIZE_FROM: f64 = 7.0;
/// Residuals above this fraction of the signal are outliers in attempt 3; the thesis selected them by eye.
const OUTLIER: f64 = 0.2;

/// The speeds of the fits \[m/s\].
fn fitted_speeds(study: &Study) -> Vec<f64> {
    speeds(10.0, if study.quick { 20 } else { 100 })
}

/// The response of the uncontrolled bicycle over at most `time_limit_s`, every `every`th point; if it falls, without its last eighth.
fn response(
    study: &Study,
    time_limit_s: f64,
    (speed, disturbance): (f64, f64),
    every: usize,
) -> Vec<TracePoint> {
    let conditions = Conditions { time_limit_s, ..conditions(study) };
    let start = Start { speed_m_s: speed, steer_rate_rad_s: disturbance, roll_rate_rad_s: 0.0 };
    let (ride, mut trace) = traced(&conditions, start);
    if ride.fell() {
        trace.truncate(trace.len() * 7 / 8);
    }
    trace.into_iter().step_by(every).collect()
}

fn conditions(study: &Study) -> Conditions {
    Conditions::thesis(study.bicycle, Assist::None)
}

fn samples(trace: &[TracePoint], from_s: f64, of: fn(&TracePoint) -> f64) -> Vec<(f64, f64)> {
    let selected = trace.iter().filter(|p| p.t >= from_s);
    selected.map(|p| (p.t - from_s, of(p))).collect()
}

/// Attempt 1: unbounded, roll rate.
pub fn figure_c_1(study: &Study) -> Item {
    let fits = each(study, |trace, _| oscillation(&samples(trace, 0.0, |p| p.roll_rate)));
    let caption = "Attempt 1: one damped oscillation fitted to the roll rate by the simplex method without bounds, \
                   from plain starting values. Grey: the true eigenvalues.";
    attempt(study, "figure-C.1", "Fits to the roll rate", caption, &fits)
}

/// Attempt 2: unbounded, steer rate.
pub fn figure_c_2(study: &Study) -> Item {
    let fits = each(study, |trace, _| oscillation(&samples(trace, LEFT_OUT_S, |p| p.steer_rate)));
    let caption = "Attempt 2: the same fitted to the steer rate without its first half second. Grey: the true eigenvalues.";
    attempt(study, "figure-C.2", "Fits to the steer rate", caption, &fits)
}

/// A fit at every speed.
fn each(study: &Study, fit: impl Fn(&[TracePoint], f64) -> Fitted + Sync) -> Vec<(f64, Fitted)> {
    let whole_s = conditions(study).time_limit_s;
    let response = |v: f64| study.responses.get(v, || response(study, whole_s, (v, DISTURBANCE), EVERY));
    let at = |v: f64| (v, fit(&response(v), v));
    fitted_speeds(study).into_par_iter().map(at).collect()
}

fn attempt(study: &Study, name: &str, title: &str, caption: &str, fits: &[(f64, Fitted)]) -> Item {
    let fitted = vec![
        Series::new(
            "fitted real part",
            Look::marks(4, Marker::Dot),
            fits.iter().map(|(v, f)| (*v, f.real)).collect(),
        ),
        Series::new(
            "fitted imaginary part",
            Look::marks(1, Marker::Dot),
            fits.iter().map(|(v, f)| (*v, f.imaginary)).collect(),
        ),
    ];
    let chart = over_true(study, title, fitted);
    Item {
        figures: vec![Figure::of_chart(name, caption, &chart)],
        tables: vec![accuracy(study, fits)],
        ..Item::default()
    }
}

/// A chart with the true eigenvalues in the background.
fn over_true(study: &Study, title: &str, fitted: Vec<Series>) -> Chart {
    let lines = eigen_lines(study, Assisted::Alone, &speeds(10.0, 500));
    let behind =
        same_name("true eigenvalues", Look::line(0, Line::Faint), [lines.real, lines.imaginary].concat());
    let plot = Plot {
        x: Axis::new(SPEED).over(0.0, 10.0),
        y: Axis::new("Eigenvalue λ [1/s], [rad/s]").over(-10.0, 10.0),
        series: [behind, fitted].concat(),
        ..Plot::default()
    };
    Chart { title: title.into(), columns: 1, plots: vec![plot], shaded: String::new() }
}

fn true_four(study: &Study, v: f64) -> [Complex<f64>; 4] {
    eigenvalues(&study.linear, &Law::None, v)
}

/// The eigenvalue of the weave pair, or the rightmost real one if there is no pair.
fn weave(study: &Study, v: f64) -> Complex<f64> {
    let four = true_four(study, v);
    four.into_iter().find(|e| e.im > 0.0).unwrap_or(four[0])
}

/// Errors of the fits with respect to the weave eigenvalue.
fn accuracy(study: &Study, fits: &[(f64, Fitted)]) -> Table {
    let errors = |of: &dyn Fn(&Fitted, Complex<f64>) -> f64| {
        let mut all: Vec<f64> = fits.iter().map(|(v, f)| of(f, weave(study, *v)).abs()).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let row = |name: &str, errors: Vec<f64>| {
        let good = errors.iter().filter(|e| **e <= 0.05).count();
        let median = errors.get(errors.len() / 2).copied().unwrap_or(f64::NAN);
        vec![name.into(), format!("{median:.3}"), format!("{good} of {}", errors.len())]
    };
    Table {
        title: "Distance of the fits from the weave eigenvalue".into(),
        columns: ["part", "median error", "fits within 0.05"].map(String::from).to_vec(),
        rows: vec![
            row("real [1/s]", errors(&|f, e| f.real - e.re)),
            row("imaginary [rad/s]", errors(&|f, e| f.imaginary - e.im)),
        ],
    }
}

/// Attempt 3: bounded, with a capsize mode from 7 m/s, outliers removed; and the matrix pencil.
pub fn figure_c_3(study: &Study) -> Item {
    let weaves: Vec<_> = speeds(10.0, 100).into_iter().map(|v| weave(study, v)).collect();
    let range = |of: fn(&Complex<f64>) -> f64| {
        let values = weaves.iter().map(of);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |r, x| (r.0.min(x), r.1.max(x)))
    };
    let ((_, omega), (least, most)) = (range(|e| e.im), range(|e| -e.re));
    let bounds = Bounds { omega: 0.0..=omega, beta: least..=most };
    let fits = each(study, |trace, v| {
        let samples = samples(trace, 0.0, |p| p.roll_rate);
        // Late in the motion, only the capsize mode remains.
        if v < CAPSIZE_FROM { bounded(&samples, &bounds) } else { decay(&samples[samples.len() / 2..]) }
    });
    let (selected, outliers): (Vec<_>, Vec<_>) = fits.into_iter().partition(|(_, f)| f.residual <= OUTLIER);
    let (oscillations, capsizes): (Vec<_>, Vec<_>) =
        selected.into_iter().partition(|(v, _)| *v < CAPSIZE_FROM);
    let points =
        |fits: &[(f64, Fitted)], of: fn(&Fitted) -> f64| fits.iter().map(|(v, f)| (*v, of(f))).collect();
    let fitted = vec![
        Series::new(
            "fitted real part, weave",
            Look::marks(4, Marker::Dot),
            points(&oscillations, |f| f.real),
        ),
        Series::new(
            "fitted imaginary part",
            Look::marks(1, Marker::Dot),
            points(&oscillations, |f| f.imaginary),
        ),
        Series::new("fitted real part, capsize", Look::marks(5, Marker::Dot), points(&capsizes, |f| f.real)),
    ];
    let caption = "Attempt 3: the oscillation fitted to the roll rate within the bounds of the true weave eigenvalues, a \
                   capsize to its second half from 7 m/s on, fits with a residual above a fifth of the signal removed.";
    let thesis = Figure::of_chart("figure-C.3", caption, &over_true(study, "Fits within bounds", fitted));
    let (tables, pencil) = matrix_pencil(study);
    let note = format!("{} of the fits are outliers and not drawn.", outliers.len());
    let tables = [vec![accuracy(study, &oscillations)], tables].concat();
    Item { figures: vec![thesis, pencil], tables, notes: vec![note], ..Item::default() }
}

/// The four eigenvalues that the matrix pencil estimates from roll rate and steer rate.
pub fn pencil_at(study: &Study, speed: f64, disturbance: f64) -> Option<[Complex<f64>; 4]> {
    const DT: usize = 20;
    const SAMPLES: usize = 61;
    // A ride so long that a fall does not shorten the samples if a longer one's would not.
    let needed_s = conditions(study).step_s * (DT * SAMPLES) as f64 * 8.0 / 7.0;
    let trace = response(study, needed_s, (speed, disturbance), DT);
    let signal = |of: fn(&TracePoint) -> f64| trace.iter().take(SAMPLES).map(of).collect();
    let signals: [Vec<f64>; 4] =
        [signal(|p| p.roll_rate), signal(|p| p.steer_rate), signal(|p| p.roll), signal(|p| p.steer)];
    matrix_pencil::eigenvalues(&signals, 1e-3 * DT as f64, 4)?.try_into().ok()
}

/// The largest distance of `found` from the corresponding eigenvalues of `true_four` \[1/s\].
pub fn pencil_error(study: &Study, speed: f64, found: &[Complex<f64>; 4]) -> f64 {
    let exact = true_four(study, speed);
    let nearest = |e: &Complex<f64>| found.iter().map(|f| (f - e).modulus()).fold(f64::INFINITY, f64::min);
    exact.iter().map(nearest).fold(0.0, f64::max)
}

/// All four eigenvalues from the same rides, which a single oscillation cannot give.
fn matrix_pencil(study: &Study) -> (Vec<Table>, Figure) {
    let at = |disturbance: f64| -> Vec<(f64, Option<[Complex<f64>; 4]>)> {
        let found = |v: f64| (v, pencil_at(study, v, disturbance));
        fitted_speeds(study).into_par_iter().map(found).collect()
    };
    let tiny = at(TINY);
    let points = |of: fn(&Complex<f64>) -> f64, keep: fn(&Complex<f64>) -> bool| {
        let all = tiny.iter().filter_map(|(v, four)| four.as_ref().map(|four| (*v, four)));
        all.flat_map(|(v, four)| four.iter().filter(|e| keep(e)).map(move |e| (v, of(e)))).collect()
    };
    let found = vec![
        Series::new("real parts found", Look::marks(0, Marker::Point), points(|e| e.re, |_| true)),
        Series::new(
            "imaginary parts found",
            Look::marks(1, Marker::Point),
            points(|e| e.im, |e| e.im > 1e-3),
        ),
    ];
    let mut chart = over_true(study, "All four eigenvalues by matrix pencil", found);
    chart.plots[0].y.range = Some((-40.0, 10.0));
    let caption = format!(
        "All four eigenvalues from 1.2 s of roll, steer and their rates after a steer rate of {TINY} rad/s, by the \
         matrix pencil. Grey: the true eigenvalues."
    );
    let row = |name: String, all: &[(f64, Option<[Complex<f64>; 4]>)]| {
        let errors = all.iter().map(|(v, four)| four.map_or(f64::INFINITY, |f| pencil_error(study, *v, &f)));
        let mut errors: Vec<f64> = errors.collect();
        errors.sort_by(f64::total_cmp);
        let number = |i: usize| errors.get(i).map_or(String::new(), |e| format!("{e:.1e}"));
        vec![name, number(errors.len() / 2), number(errors.len().saturating_sub(1))]
    };
    let table = Table {
        title: "Matrix pencil: the worst of the four eigenvalues over all speeds".into(),
        columns: ["disturbance", "median error [1/s]", "largest error [1/s]"].map(String::from).to_vec(),
        rows: vec![
            row(format!("{TINY} rad/s"), &tiny),
            row("0.001 rad/s".into(), &at(1e-3)),
            row(format!("{DISTURBANCE} rad/s"), &at(DISTURBANCE)),
        ],
    };
    (vec![table], Figure::of_chart("figure-C.3-pencil", &caption, &chart))
}
