//! Table of `identify weave`.

use super::document::{RecordingEntry, WeaveDocument, WeaveEntry};
use serde::Serialize;

/// A line: a recording, or the pooled repeats at one gain and speed.
#[derive(Clone, Debug, Serialize)]
pub struct WeaveRow {
    kind: &'static str,
    file: String,
    gain: Option<f64>,
    speed_m_s: f64,
    repeats: usize,
    from_s: Option<f64>,
    to_s: Option<f64>,
    decay_1_s: Option<f64>,
    decay_error: Option<f64>,
    decay_low: Option<f64>,
    decay_high: Option<f64>,
    decay_between: Option<f64>,
    frequency_rad_s: Option<f64>,
    frequency_error: Option<f64>,
    frequency_low: Option<f64>,
    frequency_high: Option<f64>,
    frequency_between: Option<f64>,
    mode_1_s: Option<f64>,
    perfect_decay_1_s: Option<f64>,
    perfect_frequency_rad_s: Option<f64>,
    fitted_decay_1_s: Option<f64>,
    fitted_frequency_rad_s: Option<f64>,
}

/// The lines, recordings first.
pub fn rows(document: &WeaveDocument) -> Vec<WeaveRow> {
    document.recordings.iter().map(recording).chain(document.weave.iter().map(pooled)).collect()
}

fn recording(entry: &RecordingEntry) -> WeaveRow {
    let (decay, frequency) = (entry.weave.decay_1_s, entry.weave.frequency_rad_s);
    WeaveRow {
        kind: "recording",
        file: entry.file.clone(),
        gain: entry.gain,
        speed_m_s: entry.speed_m_s,
        repeats: 1,
        from_s: Some(entry.weave.from_s),
        to_s: Some(entry.weave.to_s),
        decay_1_s: Some(decay.value),
        decay_error: Some(decay.standard_error),
        decay_low: Some(decay.low),
        decay_high: Some(decay.high),
        decay_between: None,
        frequency_rad_s: Some(frequency.value),
        frequency_error: Some(frequency.standard_error),
        frequency_low: Some(frequency.low),
        frequency_high: Some(frequency.high),
        frequency_between: None,
        mode_1_s: entry.weave.mode_1_s,
        perfect_decay_1_s: None,
        perfect_frequency_rad_s: None,
        fitted_decay_1_s: None,
        fitted_frequency_rad_s: None,
    }
}

fn pooled(entry: &WeaveEntry) -> WeaveRow {
    let (decay, frequency) = (entry.decay_1_s, entry.frequency_rad_s);
    let part = |root: Option<[f64; 2]>, i: usize| root.map(|r| r[i]);
    WeaveRow {
        kind: "pooled",
        file: String::new(),
        gain: entry.gain,
        speed_m_s: entry.speed_m_s,
        repeats: entry.repeats,
        from_s: None,
        to_s: None,
        decay_1_s: decay.map(|d| d.mean.value),
        decay_error: decay.map(|d| d.mean.standard_error),
        decay_low: decay.map(|d| d.mean.low),
        decay_high: decay.map(|d| d.mean.high),
        decay_between: decay.and_then(|d| d.between),
        frequency_rad_s: frequency.map(|f| f.mean.value),
        frequency_error: frequency.map(|f| f.mean.standard_error),
        frequency_low: frequency.map(|f| f.mean.low),
        frequency_high: frequency.map(|f| f.mean.high),
        frequency_between: frequency.and_then(|f| f.between),
        mode_1_s: None,
        perfect_decay_1_s: part(entry.predicted.perfect, 0),
        perfect_frequency_rad_s: part(entry.predicted.perfect, 1),
        fitted_decay_1_s: part(entry.predicted.fitted, 0),
        fitted_frequency_rad_s: part(entry.predicted.fitted, 1),
    }
}
