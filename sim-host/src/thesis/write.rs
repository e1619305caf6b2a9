//! Writes the report's files.

use super::document::ThesisDocument;
use super::html::page;
use super::run::Outcome;
use crate::report::output::Output;
use crate::report::picture::{caption, svg_with_caption};
use std::path::{Path, PathBuf};

/// Name of the report's page in its folder.
pub const PAGE: &str = "report.html";
const FIGURES: &str = "figures";

/// Why a report cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("can't write the report to {folder}: {reason}")]
pub struct WriteError {
    folder: PathBuf,
    reason: String,
}

/// Prepares to write a report into `folder`, so that an error appears before the computation.
///
/// # Errors
/// The folder cannot be created or is not writable.
pub fn prepare(folder: &Path) -> Result<(), WriteError> {
    let failed = |reason: String| WriteError { folder: folder.into(), reason };
    std::fs::create_dir_all(folder.join(FIGURES)).map_err(|e| failed(e.to_string()))?;
    Output::create(&folder.join(PAGE)).map(drop).map_err(|e| failed(e.to_string()))
}

/// Writes `report.html`, `values.csv`, `values.json` and, for each figure, `figures/NAME.svg` and `.csv`; existing
/// files of these names are replaced.
///
/// # Errors
/// A file cannot be written.
pub fn write(folder: &Path, document: &ThesisDocument, outcomes: &[Outcome]) -> Result<(), WriteError> {
    let failed = |reason: String| WriteError { folder: folder.into(), reason };
    let put = |name: &str, content: &str| {
        let output = Output::create(&folder.join(name)).map_err(|e| failed(e.to_string()))?;
        output.finish(content.as_bytes()).map_err(|e| failed(e.to_string()))
    };
    let config = serde_json::json!({"quick": document.quick, "resolution": document.resolution});
    for figure in outcomes.iter().filter_map(|o| o.item.as_ref()).flat_map(|i| &i.figures) {
        let about = format!("{} {}", figure.caption, caption(&config));
        put(&format!("{FIGURES}/{}.svg", figure.name), &svg_with_caption(&figure.picture.svg(), &about))?;
        put(&format!("{FIGURES}/{}.csv", figure.name), &figure.csv)?;
    }
    put("values.csv", &document.csv().map_err(|e| failed(e.to_string()))?)?;
    let json = serde_json::to_string_pretty(document).map_err(|e| failed(e.to_string()))?;
    put("values.json", &(json + "\n"))?;
    put(PAGE, &page(document, outcomes))
}
