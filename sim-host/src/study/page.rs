//! A study's page: Markdown text and a figure.

use crate::report::figure::{Chart, chart};
use crate::report::output::{Output, OutputError};
use crate::report::picture::svg_with_caption;
use std::path::Path;

/// A page and its figure, written to `NAME.md` and `NAME.svg`.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// The name of both files, without extension.
    pub name: &'static str,
    /// Markdown.
    pub text: String,
    /// The figure.
    pub chart: Chart,
}

/// The destinations of a page's files, checked before the computation.
#[derive(Debug)]
pub struct Places {
    text: Output,
    figure: Output,
}

impl Places {
    /// Prepares to write the page `name` into `folder`.
    ///
    /// # Errors
    /// The folder does not exist or is not writable.
    pub fn create(folder: &Path, name: &str) -> Result<Self, OutputError> {
        let place = |ending: &str| Output::create(&folder.join(format!("{name}.{ending}")));
        Ok(Self { text: place("md")?, figure: place("svg")? })
    }

    /// Writes the page's files.
    ///
    /// # Errors
    /// The system's error.
    pub fn write(&self, page: &Page) -> Result<(), OutputError> {
        let svg = svg_with_caption(&chart(&page.chart).svg(), &page.chart.title);
        self.figure.finish(svg.as_bytes())?;
        self.text.finish(page.text.as_bytes())
    }
}

/// A Markdown table.
pub fn table(heading: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let heading: Vec<String> = heading.iter().map(|cell| (*cell).to_owned()).collect();
    let rule = vec!["---".to_owned(); heading.len()];
    let rows: String = rows.into_iter().map(|row| line(&row)).collect();
    line(&heading) + &line(&rule) + &rows
}
