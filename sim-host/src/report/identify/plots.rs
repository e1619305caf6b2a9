//! Panels of an identified rider's figures: signals over time, the profile of the delay.

use super::document::IdentifyDocument;
use crate::identify::{DROP_95, Identified, Signal};
use crate::report::figure::{Axis, Line, Look, Marker, Plot, Series, thinned};
use std::ops::Range;

/// Intervals of time in which a curve keeps its extremes: more than a panel has pixels.
const BINS: f64 = 900.0;
/// Largest drop of the log-likelihood that is drawn; a 95 % interval ends at 1.92.
const HIGHEST_DROP: f64 = 10.0;
/// Everything that is drawn over time.
pub(super) struct Course<'a> {
    found: &'a Identified,
    response: Vec<[f64; 3]>,
    /// Residual of each measured signal; NaN where it is not fitted.
    pub(super) residuals: Vec<Vec<f64>>,
}

/// Name, index in a response, name of the axis for an angle or a rate in degrees.
pub(super) fn of_signal(signal: Signal) -> (usize, &'static str) {
    match signal {
        Signal::Roll => (0, "Roll [deg]"),
        Signal::Steer => (1, "Steer [deg]"),
        Signal::RollRate => (2, "Roll rate [deg/s]"),
    }
}

/// Index of a disturbance, its name, its axis.
pub(super) type Input = (usize, &'static str, &'static str);

/// The disturbances that the record has.
pub(super) fn inputs(found: &Identified) -> Vec<Input> {
    let samples = &found.problem.record.disturbances.samples;
    [(0, "lateral force", "Lateral force [N]"), (1, "steer torque", "Steer torque [N m]")]
        .into_iter()
        .filter(|(input, ..)| samples.iter().any(|x| x[*input] != 0.0))
        .collect()
}

impl<'a> Course<'a> {
    pub(super) fn new(found: &'a Identified) -> Self {
        Self { found, response: found.response(), residuals: found.residuals() }
    }

    /// All samples that are fitted.
    pub(super) fn fitted(&self) -> Range<usize> {
        let record = &self.found.problem.record;
        self.at(self.found.problem.skip_s).min(record.len())..record.len()
    }

    /// The samples from one time to another \[s\], as far as they are fitted.
    pub(super) fn between(&self, from_s: f64, to_s: f64) -> Range<usize> {
        let Range { start, end } = self.fitted();
        self.at(from_s).clamp(start, end)..self.at(to_s).clamp(start, end)
    }

    fn at(&self, time_s: f64) -> usize {
        (time_s.max(0.0) / self.found.problem.record.disturbances.sample_s).round() as usize
    }

    /// Start of the first fitted perturbation \[s\].
    pub(super) fn first_onset_s(&self) -> Option<f64> {
        let disturbances = &self.found.problem.record.disturbances;
        let moves = |k: usize| disturbances.samples[k].iter().any(|x| *x != 0.0);
        let first = self.fitted().skip(1).find(|k| moves(*k) && !moves(*k - 1))?;
        Some(first as f64 * disturbances.sample_s)
    }

    /// A curve over `samples`, thinned, interrupted where there is no value.
    fn curve(&self, samples: &Range<usize>, value: impl Fn(usize) -> f64) -> Vec<(f64, f64)> {
        let sample_s = self.found.problem.record.disturbances.sample_s;
        let points: Vec<(f64, f64)> = samples.clone().map(|k| (k as f64 * sample_s, value(k))).collect();
        let bin = samples.len() as f64 * sample_s / BINS;
        let mut curve = Vec::new();
        for piece in points.chunk_by(|a, b| a.1.is_finite() == b.1.is_finite()) {
            match piece {
                [(time_s, value), ..] if !value.is_finite() => curve.push((*time_s, f64::NAN)),
                _ => curve.extend(thinned(piece.iter().copied(), bin)),
            }
        }
        curve
    }

    fn over_time(&self, samples: &Range<usize>, axis: &str, series: Vec<Series>) -> Plot {
        let sample_s = self.found.problem.record.disturbances.sample_s;
        let time = Axis::new("Time from the record's start [s]");
        let x = time.over(samples.start as f64 * sample_s, samples.end as f64 * sample_s);
        Plot { x, y: Axis::new(axis), series, ..Plot::default() }
    }

    /// A disturbance.
    pub(super) fn disturbance(&self, (input, name, axis): Input, samples: &Range<usize>) -> Plot {
        let values = &self.found.problem.record.disturbances.samples;
        let curve = self.curve(samples, |k| values[k][input]);
        self.over_time(samples, axis, vec![Series::new(name, Look::line(2, Line::Solid), curve)])
    }

    /// A measured signal without its drift, and the model's.
    pub(super) fn signal(&self, index: usize, samples: &Range<usize>) -> Plot {
        let (state, axis) = of_signal(self.found.problem.record.measured[index].signal);
        let modelled = |k: usize| self.response.get(k).map_or(f64::NAN, |x| x[state].to_degrees());
        let measured = |k: usize| modelled(k) + self.residuals[index][k].to_degrees();
        let series = vec![
            Series::new("measured, without drift", Look::line(0, Line::Faint), self.curve(samples, measured)),
            Series::new("model", Look::line(1, Line::Solid), self.curve(samples, modelled)),
        ];
        self.over_time(samples, axis, series)
    }

    /// The residual of a signal.
    pub(super) fn residual(&self, index: usize, samples: &Range<usize>) -> Plot {
        let (_, axis) = of_signal(self.found.problem.record.measured[index].signal);
        let curve = self.curve(samples, |k| self.residuals[index][k].to_degrees());
        let name = "residual: measured less model";
        let axis = format!("Residual: {}", axis.to_lowercase());
        self.over_time(samples, &axis, vec![Series::new(name, Look::line(0, Line::Solid), curve)])
    }
}

/// The profile likelihood of the delay, near its maximum; `None` without one.
pub(super) fn delay(document: &IdentifyDocument) -> Option<Plot> {
    let delay = document.delay.as_ref()?;
    let point = |entry: &super::document::DelayEntry| (1e3 * entry.delay_s, entry.log_likelihood_drop);
    let points: Vec<(f64, f64)> = delay.profile.iter().map(point).collect();
    let ends = (points.first()?.0, points.last()?.0);
    let look = Look { marker: Some(Marker::Dot), ..Look::line(3, Line::Solid) };
    let limit = vec![(ends.0, DROP_95), (ends.1, DROP_95)];
    let shaded = (1e3 * delay.low_s.unwrap_or(0.0), delay.high_s.map_or(ends.1, |s| 1e3 * s));
    Some(Plot {
        x: Axis::new("Neural delay [ms]").over(ends.0, ends.1),
        y: Axis::new("Drop of the log-likelihood [-]").over(0.0, HIGHEST_DROP),
        series: vec![
            Series::new("profile likelihood of the delay", look, points),
            Series::new("drop of 1.92: 95 % interval", Look::line(4, Line::Dotted), limit),
        ],
        shaded: vec![shaded],
        verticals: vec![1e3 * delay.estimate_s],
        ..Plot::default()
    })
}

/// Meaning of the shaded range of [`delay`].
pub(super) const DELAY_SHADED: &str = "95 % interval of the delay";
