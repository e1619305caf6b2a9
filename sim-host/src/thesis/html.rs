//! The report as a single, self-contained HTML page.

use super::catalogue::Made;
use super::document::{Compared, ThesisDocument, ValueEntry};
use super::item::{ACCEPTED_PERCENT, Table};
use super::published::remarks;
use super::run::Outcome;
use crate::report::html::{self, escaped};
use std::fmt::Write;

const STYLE: &str = include_str!("report.css");

/// The page.
pub(super) fn page(document: &ThesisDocument, outcomes: &[Outcome]) -> String {
    let mut body = String::new();
    let _ = write!(
        body,
        "<h1>The Stability of a Bicycle-Rider System, computed again</h1>\n{}",
        summary(document)
    );
    body += &contents(outcomes);
    for outcome in outcomes {
        body += &section(document, outcome);
    }
    html::page("Kuipers 2020, computed again", STYLE, &body)
}

fn summary(document: &ThesisDocument) -> String {
    let Compared { printed, close, explained, unexplained, missing } = Compared::of(&document.values);
    let r = &document.resolution;
    let tool = &document.tool;
    let cut = if document.complete {
        ""
    } else {
        "<p class=\"unexplained\">Interrupted: some items are missing.</p>\n"
    };
    format!(
        "<p>Every table and computed figure of Kuipers, <cite>The Stability of a Bicycle-Rider System</cite>, Delft \
         2020, by {} {} (commit {}), in {:.0} s.</p>\n{cut}\
         <p>Of {printed} printed numbers <b>{close}</b> are met within {ACCEPTED_PERCENT} %, the rounding of the print or the printed bound, <b>{explained}</b> differ and are \
         explained by another reading of the text that was computed too, <b>{unexplained}</b> differ unexplained, \
         {missing} have no computed counterpart.</p>\n\
         <p>“Exact” is the value of the model: rides of 6 s, a fall at 90 degrees of roll or steer, gains set by the \
         front wheel's speed, borders located within {} rad/s at every {} m/s{}. “On the grid” is the same on \
         disturbances in steps of 0.5 rad/s, the last before the first that falls: what the thesis probably did. \
         Disturbances are initial steer rates.</p>\n",
        tool.name,
        tool.version,
        tool.commit,
        document.seconds,
        r.tolerance,
        r.rider_speed_step,
        if document.quick { " (a quick look, coarser than the full report)" } else { "" },
    )
}

fn contents(outcomes: &[Outcome]) -> String {
    let mut text = String::from("<details class=\"contents\" open><summary>Contents</summary>\n<ol>\n");
    for Outcome { entry, .. } in outcomes {
        let _ = writeln!(
            text,
            "<li><a href=\"#{}\">{}</a> {}</li>",
            entry.name,
            escaped(&entry.label()),
            escaped(entry.title)
        );
    }
    text + "</ol>\n</details>\n"
}

fn section(document: &ThesisDocument, outcome: &Outcome) -> String {
    let entry = outcome.entry;
    let mut text = format!(
        "<section id=\"{}\">\n<h2>{}: {}</h2>\n",
        entry.name,
        escaped(&entry.label()),
        escaped(entry.title)
    );
    match (&outcome.item, &entry.made) {
        (None, Made::Unavailable(reason)) => {
            let _ = writeln!(text, "<p class=\"note\">Not computed: {}.</p>", escaped(reason));
        }
        (None, Made::Computed { .. }) => text += "<p class=\"note\">Interrupted.</p>\n",
        (Some(item), _) => {
            item.figures.iter().for_each(|f| text += &html::figure(&f.name, &f.picture, &f.caption));
            let values: Vec<&ValueEntry> = document.values.iter().filter(|v| v.item == entry.name).collect();
            text += &comparison(&values);
            item.tables.iter().for_each(|t| text += &table(t));
            for note in item.notes.iter().cloned().chain(remarks(entry.name)) {
                let _ = writeln!(text, "<p class=\"note\">{}</p>", escaped(&note));
            }
        }
    }
    text + "</section>\n"
}

fn number(x: Option<f64>) -> String {
    let Some(x) = x else { return "–".into() };
    let size = if x == 0.0 { 0.0 } else { libm::log10(x.abs()).floor() };
    let decimals = (3.0 - size).clamp(0.0, 6.0) as usize;
    format!("{x:.decimals$}").replace('-', "−")
}

fn comparison(values: &[&ValueEntry]) -> String {
    if values.is_empty() {
        return String::new();
    }
    let mut text = String::from(
        "<div class=\"wide\"><table>\n<thead><tr><th>of</th><th>what</th><th>published</th><th>exact</th>\
         <th>on the grid</th><th>difference</th><th>explanation</th></tr></thead>\n<tbody>\n",
    );
    for value in values.iter().filter(|v| v.published.is_some() || v.exact.is_some()) {
        let unit = if value.unit.is_empty() { String::new() } else { format!(" [{}]", value.unit) };
        let difference =
            value.difference_percent.map_or("–".into(), |d| format!("{d:+.1} %").replace('-', "−"));
        let _ = writeln!(
            text,
            "<tr class=\"{}\"><td>{}</td><td>{}{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>\
             <td class=\"n\">{}</td><td class=\"n\">{difference}</td><td>{}</td></tr>",
            value.kind(),
            escaped(&value.row),
            escaped(&value.column),
            escaped(&unit),
            number(value.published),
            number(value.exact) + if value.capped { " (capped)" } else { "" },
            number(value.coarse),
            explanation(value)
        );
    }
    text + "</tbody></table></div>\n"
}

fn explanation(value: &ValueEntry) -> String {
    let mut text = escaped(&value.explanation);
    if value.kind() != "close" && !value.experiments.is_empty() {
        text += "<ul>";
        for e in &value.experiments {
            let _ = write!(text, "<li>{}: {}</li>", escaped(&e.name), number(Some(e.value)));
        }
        text += "</ul>";
    }
    text
}

fn table(table: &Table) -> String {
    let rows: Vec<Vec<String>> =
        table.rows.iter().map(|cells| cells.iter().map(|cell| escaped(cell)).collect()).collect();
    html::table(&table.title, &table.columns, &rows)
}
