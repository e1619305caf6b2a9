//! The report of an identified rider: a self-contained HTML page.

mod about;
mod figures;
mod gains;
mod search;

use super::document::IdentifyDocument;
use super::plots::Course;
use crate::identify::Identified;
use crate::report::html::{self, escaped};

const STYLE: &str = include_str!("page.css");

/// Magnitude below which a number is shown as zero.
const ZERO: f64 = 1e-6;

/// The page. `command` is the command line that made it, `rider` the text of the rider's file.
pub fn page(document: &IdentifyDocument, found: &Identified, command: &str, rider: &str) -> String {
    let course = Course::new(found);
    let text = |text: &str| format!("<pre>{}</pre>\n", escaped(text));
    let sections = [
        ("fitted", "What was fitted", about::fitted(document)),
        ("gains", "Gains", gains::gains(document, found)),
        ("not-identified", "Gains that are or may be zero", gains::insignificant(document)),
        ("signals", "Measured and modelled signals", figures::signals(found, &course)),
        ("residuals", "Residuals", figures::residuals(found, &course)),
        ("impulse-response", "Impulse response", figures::impulse_responses(found)),
        ("reduction", "Reduction of the gains", search::reduction(document)),
        ("optima", "Distinct optima", search::optima(document)),
        ("delay", "Neural delay", search::delay(document)),
        ("command", "Command", text(command)),
        ("rider-file", "The rider's file", text(rider)),
    ];
    let title = format!("Rider identified from {}", document.record.file);
    let mut body = format!("<h1>{}</h1>\n{}", escaped(&title), about::summary(document));
    for (name, title, content) in sections.into_iter().filter(|(.., content)| !content.is_empty()) {
        body += &format!("<section id=\"{name}\">\n<h2>{title}</h2>\n{content}</section>\n");
    }
    html::page(&title, STYLE, &body)
}

/// A paragraph of plain text.
fn paragraph(text: &str) -> String {
    format!("<p>{}</p>\n", escaped(text))
}

/// A number as a reader wants it, with all digits for a program.
fn number(x: f64) -> String {
    // Without noise, gains that the rider lacks are found as tiny numbers.
    let shown = super::text::number(if x.abs() < ZERO { 0.0 } else { x }).replace('-', "−");
    format!("<data value=\"{x}\">{shown}</data>")
}

/// A list of plain texts.
fn list<'a>(items: impl IntoIterator<Item = &'a str>) -> String {
    let items: String = items.into_iter().map(|item| format!("<li>{}</li>\n", escaped(item))).collect();
    format!("<ul>\n{items}</ul>\n")
}
