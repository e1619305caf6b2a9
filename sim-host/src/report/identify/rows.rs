//! The reduction as a table: one line for each step and gain.

use serde::Serialize;
use serde_json::Value;

/// A gain of a step.
#[derive(Clone, Debug, Serialize)]
pub struct ReductionRow {
    record: String,
    step: usize,
    selected: bool,
    gain: String,
    value: Option<f64>,
    std_error: Option<f64>,
    vaf: Option<f64>,
    vaf_after_onset: Option<f64>,
    vaf_cross_validated: Option<f64>,
    aic: Option<f64>,
    bic: Option<f64>,
}

/// All steps of the reduction of a document: the JSON of [`super::IdentifyDocument`], which may have been written before.
pub fn rows(document: &Value) -> Vec<ReductionRow> {
    let steps = document["reduction"].as_array().into_iter().flatten().enumerate();
    let of = |(step, entry): (usize, &Value)| {
        let number = |key: &str| entry[key].as_f64();
        let row = |(gain, value): (&String, &Value)| ReductionRow {
            record: document["record"]["file"].as_str().unwrap_or_default().into(),
            step,
            selected: document["selected"].as_u64() == Some(step as u64),
            gain: gain.clone(),
            value: value["value"].as_f64(),
            std_error: value["std_error"].as_f64(),
            vaf: number("vaf"),
            vaf_after_onset: number("vaf_after_onset"),
            vaf_cross_validated: number("vaf_cross_validated"),
            aic: number("aic"),
            bic: number("bic"),
        };
        entry["gains"].as_object().into_iter().flatten().map(row).collect::<Vec<_>>()
    };
    steps.flat_map(of).collect()
}
