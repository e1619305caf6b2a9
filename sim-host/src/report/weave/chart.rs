//! Figure of `identify weave`: decay and frequency over speed, a row for each gain.

use super::document::{RecordingEntry, WeaveDocument, WeaveEntry};
use crate::report::figure::{Axis, Chart, Line, Look, Marker, Plot, Series};
use crate::weave::Estimate;
use crate::weave::pool::Pooled;
use nalgebra::Complex;

/// The linear model's weave at one gain over speed, with an ideal and with the fitted motor.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    /// The gain.
    pub gain: Option<f64>,
    /// Forward speeds \[m/s\].
    pub speeds: Vec<f64>,
    /// Eigenvalues with an ideal motor \[1/s\].
    pub perfect: Vec<Option<Complex<f64>>>,
    /// Eigenvalues with the fitted motor \[1/s\].
    pub fitted: Vec<Option<Complex<f64>>>,
}

/// One of the two parts of an eigenvalue.
struct Part {
    label: &'static str,
    of_root: fn(Complex<f64>) -> f64,
    of_recording: fn(&RecordingEntry) -> Estimate,
    of_repeats: fn(&WeaveEntry) -> Option<Pooled>,
}

const PARTS: [Part; 2] = [
    Part {
        label: "Decay Re λ [1/s]",
        of_root: |root| root.re,
        of_recording: |entry| entry.weave.decay_1_s,
        of_repeats: |entry| entry.decay_1_s,
    },
    Part {
        label: "Frequency Im λ [rad/s]",
        of_root: |root| root.im,
        of_recording: |entry| entry.weave.frequency_rad_s,
        of_repeats: |entry| entry.frequency_rad_s,
    },
];

/// The figure; `curves` has an entry for each gain.
pub fn chart(document: &WeaveDocument, curves: &[Curves]) -> Chart {
    let plots = curves.iter().flat_map(|curves| PARTS.iter().map(|part| plot(document, curves, part)));
    Chart {
        title: "Weave after a knock: measured and modelled".into(),
        columns: 2,
        plots: plots.collect(),
        shaded: String::new(),
    }
}

fn plot(document: &WeaveDocument, curves: &Curves, part: &Part) -> Plot {
    let line = |name: &str, look, roots: &[Option<Complex<f64>>]| {
        let points =
            curves.speeds.iter().zip(roots).map(|(v, root)| (*v, root.map_or(f64::NAN, part.of_root)));
        Series::new(name, look, points.collect())
    };
    let perfect = line("model, perfect motor", Look::line(0, Line::Dashed), &curves.perfect);
    let fitted = line("model, fitted motor", Look::line(1, Line::Solid), &curves.fitted);
    let recordings = document.recordings.iter().filter(|e| e.gain == curves.gain);
    let recordings = recordings.map(|e| (e.speed_m_s, (part.of_recording)(e).value)).collect::<Vec<_>>();
    let repeats = document.weave.iter().filter(|e| e.gain == curves.gain);
    let repeats: Vec<(f64, Estimate)> =
        repeats.filter_map(|e| Some((e.speed_m_s, (part.of_repeats)(e)?.mean))).collect();
    // Wide intervals would compress the rest of the figure.
    let known = perfect.points.iter().chain(&fitted.points).chain(&recordings).map(|p| p.1);
    let (low, high) =
        known.filter(|y| y.is_finite()).fold((0.0_f64, 0.0_f64), |(a, b), y| (a.min(y), b.max(y)));
    let margin = 0.15 * (high - low).max(1.0);
    let (low, high) = (if low < 0.0 { low - margin } else { 0.0 }, high + margin);
    let bars = repeats.iter().flat_map(|(v, e)| {
        [(*v, e.low.clamp(low, high)), (*v, e.high.clamp(low, high)), (f64::NAN, f64::NAN)]
    });
    let bars = Series::new("95 % interval", Look::line(2, Line::Solid), bars.collect());
    let means = repeats.iter().map(|(v, e)| (*v, e.value)).collect();
    Plot {
        title: curves.gain.map_or(document.config.law.clone(), |gain| format!("gain {gain}")),
        x: Axis::new("Forward speed v [m/s]"),
        y: Axis::new(part.label).over(low, high),
        series: vec![
            perfect,
            fitted,
            bars,
            Series::new("one recording", Look::marks(3, Marker::Point), recordings),
            Series::new("repeats together", Look::marks(2, Marker::Ring), means),
        ],
        ..Plot::default()
    }
}
