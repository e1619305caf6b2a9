//! The reproduced values as a JSON document and as a CSV table.

use super::case::Resolution;
use super::catalogue::Made;
use super::item::{Explanation, Value};
use super::run::Outcome;
use crate::report::tool::Tool;
use schemars::JsonSchema;
use serde::Serialize;

/// The document `values.json`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ThesisDocument {
    /// Version of the document's layout.
    pub schema: u32,
    /// The program.
    pub tool: Tool,
    /// Whether `--quick` was given.
    pub quick: bool,
    /// Resolution of the basin searches.
    pub resolution: Resolution,
    /// False after an interruption with Ctrl-C.
    pub complete: bool,
    /// The requested items.
    pub items: Vec<ItemEntry>,
    /// Every number, in the items' order.
    pub values: Vec<ValueEntry>,
    /// Time taken \[s\].
    pub seconds: f64,
}

/// An item of the document.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ItemEntry {
    /// Kind and number.
    pub name: &'static str,
    /// Its title.
    pub title: &'static str,
    /// "computed", "interrupted" or "unavailable".
    pub status: &'static str,
    /// The reason if it is unavailable.
    pub reason: Option<&'static str>,
    /// Names of its figures.
    pub figures: Vec<String>,
}

/// A number of the document.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ValueEntry {
    /// The item.
    pub item: &'static str,
    /// Row.
    pub row: String,
    /// Column.
    pub column: String,
    /// Unit; empty for a pure number.
    pub unit: String,
    /// The printed number; null if none is printed.
    pub published: Option<f64>,
    /// Where it is printed (table, equation or section).
    pub from: String,
    /// The computed number; null if there is none.
    pub exact: Option<f64>,
    /// The number on the thesis's probable grid of disturbances; null where no basin is involved.
    pub coarse: Option<f64>,
    /// Difference of `exact` from `published` \[% of the latter\].
    pub difference_percent: Option<f64>,
    /// "" for a difference up to 2 % or the rounding of the print, and where a printed bound holds; "explained: WHAT",
    /// or "unexplained" with the closest experiment.
    pub explanation: String,
    /// Numbers under other readings of the thesis.
    pub experiments: Vec<ExperimentEntry>,
    /// Whether `exact` comes from a basin in which nothing fell up to the largest rate tried at some speed.
    pub capped: bool,
}

/// A number under another reading of the thesis.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct ExperimentEntry {
    /// The difference in the reading.
    pub name: String,
    /// The resulting number.
    pub value: f64,
}

impl Explanation {
    /// The explanation as text.
    pub fn text(&self) -> String {
        match self {
            Explanation::NotNeeded => String::new(),
            Explanation::Explained(by) => format!("explained: {by}"),
            Explanation::Unexplained(None) => "unexplained".into(),
            Explanation::Unexplained(Some((name, part))) => {
                format!("unexplained; {part:.0} % of it by: {name}")
            }
        }
    }
}

impl ValueEntry {
    /// "close", "explained" or "unexplained" by the comparison with the print; "" if no number is printed or none
    /// computed.
    pub fn kind(&self) -> &'static str {
        match self.published.and(self.exact) {
            None => "",
            Some(_) if self.explanation.starts_with("unexplained") => "unexplained",
            Some(_) if self.explanation.starts_with("explained") => "explained",
            Some(_) => "close",
        }
    }

    fn new(item: &'static str, value: &Value) -> Self {
        let cell = &value.cell;
        let finite = |x: Option<f64>| x.filter(|x| x.is_finite());
        let experiments = value.experiments.iter().filter(|e| e.value.is_finite());
        Self {
            item,
            row: cell.row.clone(),
            column: cell.column.clone(),
            unit: cell.unit.clone(),
            published: cell.printed.map(|p| p.value),
            from: cell.from.clone(),
            exact: finite(value.exact),
            coarse: finite(value.coarse),
            difference_percent: finite(value.difference()),
            explanation: value.explanation().text(),
            experiments: experiments
                .map(|e| ExperimentEntry { name: e.name.clone(), value: e.value })
                .collect(),
            capped: value.capped,
        }
    }
}

/// Printed numbers, by how the computed ones compare.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Compared {
    /// All printed numbers, the sum of the others.
    pub printed: usize,
    /// Met within 2 %, the rounding of the print or the printed bound.
    pub close: usize,
    /// Different, and explained by another reading of the thesis.
    pub explained: usize,
    /// Different otherwise.
    pub unexplained: usize,
    /// Without a computed counterpart.
    pub missing: usize,
}

impl Compared {
    /// Counts the printed ones of `values`.
    pub fn of(values: &[ValueEntry]) -> Self {
        let mut counts = Self::default();
        for value in values.iter().filter(|v| v.published.is_some()) {
            counts.printed += 1;
            *match value.kind() {
                "close" => &mut counts.close,
                "explained" => &mut counts.explained,
                "unexplained" => &mut counts.unexplained,
                _ => &mut counts.missing,
            } += 1;
        }
        counts
    }
}

impl ThesisDocument {
    /// The document of a run.
    pub fn new(outcomes: &[Outcome], quick: bool, resolution: Resolution, seconds: f64) -> Self {
        let items: Vec<ItemEntry> = outcomes.iter().map(item).collect();
        let values = outcomes.iter().filter_map(|o| o.item.as_ref().map(|item| (o.entry.name, item)));
        let values =
            values.flat_map(|(name, item)| item.values.iter().map(move |v| ValueEntry::new(name, v)));
        Self {
            schema: 1,
            tool: Tool::this(),
            quick,
            resolution,
            complete: items.iter().all(|i| i.status != INTERRUPTED),
            values: values.collect(),
            items,
            seconds,
        }
    }

    /// The values as a CSV table.
    ///
    /// # Errors
    /// A row cannot be written as CSV.
    pub fn csv(&self) -> Result<String, csv::Error> {
        let rows: Vec<CsvRow> = self.values.iter().map(CsvRow::new).collect();
        crate::report::table::csv_text(&rows)
    }
}

const INTERRUPTED: &str = "interrupted";

fn item(outcome: &Outcome) -> ItemEntry {
    let entry = outcome.entry;
    let (status, reason) = match (&outcome.item, &entry.made) {
        (Some(_), _) => ("computed", None),
        (None, Made::Unavailable(reason)) => ("unavailable", Some(*reason)),
        (None, Made::Computed { .. }) => (INTERRUPTED, None),
    };
    let figures = outcome.item.iter().flat_map(|item| &item.figures).map(|f| f.name.clone()).collect();
    ItemEntry { name: entry.name, title: entry.title, status, reason, figures }
}

/// A line of `values.csv`.
#[derive(Serialize)]
struct CsvRow<'a> {
    item: &'a str,
    row: &'a str,
    column: &'a str,
    unit: &'a str,
    published: Option<f64>,
    from: &'a str,
    exact: Option<f64>,
    coarse: Option<f64>,
    difference_percent: Option<f64>,
    explanation: &'a str,
    experiments: String,
    capped: bool,
}

impl<'a> CsvRow<'a> {
    fn new(value: &'a ValueEntry) -> Self {
        let experiments = value.experiments.iter().map(|e| format!("{} = {}", e.name, e.value));
        Self {
            item: value.item,
            row: &value.row,
            column: &value.column,
            unit: &value.unit,
            published: value.published,
            from: &value.from,
            exact: value.exact,
            coarse: value.coarse,
            difference_percent: value.difference_percent,
            explanation: &value.explanation,
            experiments: experiments.collect::<Vec<_>>().join("; "),
            capped: value.capped,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::thesis::published::{Cell, Printed};

    fn entry(printed: Option<&str>, exact: Option<f64>) -> ValueEntry {
        let printed = printed.map(|text| Printed::parse(text).unwrap());
        let text = String::new;
        let cell = Cell { row: text(), column: text(), unit: text(), from: text(), printed, bound: None };
        ValueEntry::new("item", &Value::new(cell, exact))
    }

    #[test]
    fn the_parts_are_all_printed_numbers() {
        let values = [
            entry(Some("5.0"), Some(5.05)),
            // No difference in percent of zero.
            entry(Some("0.0"), Some(0.04)),
            entry(Some("5.0"), Some(7.0)),
            entry(Some("5.0"), None),
            entry(None, Some(5.0)),
        ];
        let counts = Compared { printed: 4, close: 2, explained: 0, unexplained: 1, missing: 1 };
        assert_eq!(Compared::of(&values), counts);
    }
}
