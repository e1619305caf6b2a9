//! The reduction as a table: one line for each step and gain.

use super::document::IdentifyDocument;
use serde::Serialize;

/// A gain of a step.
#[derive(Clone, Debug, Serialize)]
pub struct ReductionRow {
    record: String,
    step: usize,
    selected: bool,
    gain: &'static str,
    value: f64,
    std_error: f64,
    vaf: f64,
    vaf_after_onset: Option<f64>,
    vaf_cross_validated: Option<f64>,
    aic: f64,
    bic: f64,
}

/// All steps of the reduction.
pub fn rows(document: &IdentifyDocument) -> Vec<ReductionRow> {
    let of = |(step, entry): (usize, &super::document::ReductionEntry)| {
        let row = |(gain, value): (&&'static str, &super::document::GainValue)| ReductionRow {
            record: document.record.file.clone(),
            step,
            selected: step == document.selected,
            gain,
            value: value.value,
            std_error: value.std_error,
            vaf: entry.vaf,
            vaf_after_onset: entry.vaf_after_onset,
            vaf_cross_validated: entry.vaf_cross_validated,
            aic: entry.aic,
            bic: entry.bic,
        };
        entry.gains.iter().map(row).collect::<Vec<_>>()
    };
    document.reduction.iter().enumerate().flat_map(of).collect()
}
