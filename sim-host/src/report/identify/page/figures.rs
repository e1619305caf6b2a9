//! Figures over time, of the residuals' correlations and of the impulse responses.

use super::paragraph;
use crate::identify::{Fir, Identified, Signal};
use crate::report::figure::{Axis, Chart, Line, Look, Plot, Series, chart};
use crate::report::html::figure;
use crate::report::identify::correlation::{
    autocorrelation, cross_correlation, independent_band, white_band,
};
use crate::report::identify::plots::{Course, Input, inputs, of_signal};
use std::ops::Range;

/// Time before and after the start of a perturbation that is shown in detail \[s\].
const DETAIL_S: (f64, f64) = (0.5, 4.0);
/// Longest lag of a correlation \[s\].
const LAG_S: f64 = 2.0;

/// Columns of a figure of panels over time: one as long as they fit on a printed page.
fn columns(plots: &[Plot]) -> usize {
    if plots.len() > 3 { 2 } else { 1 }
}

fn draw(name: &str, columns: usize, plots: Vec<Plot>, caption: &str) -> String {
    figure(name, &chart(&Chart { title: String::new(), columns, plots, shaded: String::new() }), caption)
}

pub(super) fn signals(found: &Identified, course: &Course) -> String {
    let of = |samples: &Range<usize>| -> Vec<Plot> {
        let disturbances = inputs(found).into_iter().map(|input| course.disturbance(input, samples));
        let measured = 0..found.problem.record.measured.len();
        disturbances.chain(measured.map(|signal| course.signal(signal, samples))).collect()
    };
    let plots = of(&course.fitted());
    let whole = draw(
        "whole-record",
        columns(&plots),
        plots,
        "The fitted part of the record; curves keep the extremes of each interval that is narrower than a pixel. The estimated \
         drift is subtracted from the measured signals.",
    );
    let Some(onset_s) = course.first_onset_s() else {
        return whole + &paragraph("The perturbation has no start within the fitted part of the record.");
    };
    let (before_s, after_s) = DETAIL_S;
    let caption = format!(
        "The first fitted perturbation, from {before_s} s before its start at {onset_s:.2} s to {after_s} s after it."
    );
    let plots = of(&course.between(onset_s - before_s, onset_s + after_s));
    whole + &draw("after-onset", columns(&plots), plots, &caption)
}

pub(super) fn residuals(found: &Identified, course: &Course) -> String {
    let signals = 0..found.problem.record.measured.len();
    let over_time = signals.clone().map(|signal| course.residual(signal, &course.fitted())).collect();
    let mut text = draw(
        "residual",
        1,
        over_time,
        "Residual: the measured signal less the drift and the model's response.",
    );
    let reach = (LAG_S / found.problem.record.disturbances.sample_s).round() as usize;
    let panels = signals.flat_map(|signal| {
        let own = own_correlation(found, course, signal, reach);
        let others =
            inputs(found).into_iter().map(move |input| with_input(found, course, signal, input, reach));
        [own].into_iter().chain(others).collect::<Vec<_>>()
    });
    let panels = panels.collect();
    text += &draw(
        "correlations",
        1 + inputs(found).len(),
        panels,
        "Autocorrelation of the residual with the 95 % band of white noise, and its correlation with the perturbation a lag before \
         with the 95 % band of sequences that are independent and coloured like these two.",
    );
    text + &paragraph(
        "A residual that is correlated with itself is coloured: the rider's own motion passes through the closed loop as the \
         response does. The standard errors account for it. A correlation with an earlier perturbation (positive lag) that leaves \
         its band is a part of the response that the model lacks; one with a later perturbation (negative lag) can only be chance, \
         or a perturbation that depends on the motion. About one lag in twenty is outside of a band by chance, and neighbouring lags \
         are not independent.",
    )
}

/// A correlation over lags with its 95 % band.
fn correlation(signal: Signal, with: &str, curve: Vec<(f64, f64)>, band: (f64, &str, usize)) -> Plot {
    let (half, name, colour) = band;
    let ends = [curve.first(), curve.last()].map(|end| end.map_or(0.0, |point| point.0));
    let edge = |half: f64| vec![(ends[0], half), (ends[1], half)];
    let filled = |half: f64| Series::new(name, Look::line(colour, Line::Filled), edge(half));
    Plot {
        title: format!("{} with {with}", signal.name()),
        x: Axis::new("Lag [s]").over(ends[0], ends[1]),
        y: Axis::new("Correlation [-]"),
        series: vec![
            filled(half),
            filled(-half),
            Series::new("correlation of the residual", Look::line(0, Line::Solid), curve),
        ],
        ..Plot::default()
    }
}

fn own_correlation(found: &Identified, course: &Course, index: usize, reach: usize) -> Plot {
    let sample_s = found.problem.record.disturbances.sample_s;
    let residual = &course.residuals[index];
    let at = |(lag, r): (usize, f64)| (lag as f64 * sample_s, r);
    let curve = autocorrelation(residual, reach).into_iter().enumerate().map(at).collect();
    let band = (white_band(residual), "95 % band of white noise", 5);
    correlation(found.problem.record.measured[index].signal, "itself", curve, band)
}

fn with_input(found: &Identified, course: &Course, index: usize, of: Input, reach: usize) -> Plot {
    let (input, name, _) = of;
    let disturbances = &found.problem.record.disturbances;
    let disturbance: Vec<f64> = disturbances.samples.iter().map(|x| x[input]).collect();
    let residual = &course.residuals[index];
    let at = |(place, r): (usize, f64)| ((place as f64 - reach as f64) * disturbances.sample_s, r);
    let curve = cross_correlation(&disturbance, residual, reach).into_iter().enumerate().map(at).collect();
    let band = (independent_band(&disturbance, residual, reach), "95 % band of independent sequences", 2);
    correlation(found.problem.record.measured[index].signal, name, curve, band)
}

pub(super) fn impulse_responses(found: &Identified) -> String {
    let measured = &found.problem.record.measured;
    let pairs = measured.iter().zip(&found.impulse_responses);
    let plots: Vec<Plot> = pairs
        .filter_map(|(measured, fir)| Some((measured.signal, fir.as_ref()?)))
        .flat_map(|(signal, fir)| {
            inputs(found).into_iter().map(move |input| impulse_response(found, signal, fir, input))
        })
        .collect();
    if plots.is_empty() {
        return paragraph(
            "The record is too short, or too little disturbed, for an impulse response without a model.",
        );
    }
    let columns = plots.len().min(2);
    draw(
        "impulse-responses",
        columns,
        plots,
        "Response to an impulse of 1 N s of the lateral force, or 1 N m s of the steer torque: a black box that knows neither bicycle \
         nor rider, and the linear model with the selected gains for the same impulse, given within one sample.",
    )
}

fn impulse_response(found: &Identified, signal: Signal, fir: &Fir, of: Input) -> Plot {
    let (input, name, _) = of;
    let (state, axis) = of_signal(signal);
    let disturbances = &found.problem.record.disturbances;
    let sample_s = disturbances.sample_s;
    let taps = &fir.taps[input];
    let black_box =
        (1..).map(|i| f64::from(i) * fir.step_s).zip(taps.iter().map(|tap| tap.to_degrees())).collect();
    let count = (taps.len() as f64 * fir.step_s / sample_s).round() as usize + 1;
    let gains = &found.fit().gains;
    let modelled = found.problem.model.impulse_response(gains, (input, disturbances.hold), sample_s, count);
    let point = |(k, x): (usize, [f64; 3])| (k as f64 * sample_s, x[state].to_degrees());
    let modelled = modelled.unwrap_or_default().into_iter().enumerate().map(point).collect();
    let per = if input == 0 { "/(N s)]" } else { "/(N m s)]" };
    Plot {
        title: format!("{} after an impulse of the {name}", signal.name()),
        x: Axis::new("Time after the impulse [s]").over(0.0, taps.len() as f64 * fir.step_s),
        y: Axis::new(&axis.replace(']', per)),
        series: vec![
            Series::new("black box", Look::line(0, Line::Faint), black_box),
            Series::new("linear model", Look::line(1, Line::Solid), modelled),
        ],
        ..Plot::default()
    }
}
