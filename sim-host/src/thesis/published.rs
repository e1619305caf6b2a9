//! What the thesis prints: `data/thesis.toml`.

use serde::Deserialize;
use std::sync::LazyLock;

/// The whole file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Published {
    /// Tables and the speeds of figures.
    pub table: Vec<Table>,
    /// Numbers from sentences and captions.
    pub quoted: Vec<Quoted>,
    /// Tables I.1 and I.2.
    pub height: Vec<Heights>,
}

/// A table of numbers; NaN where nothing is printed.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// The item that computes it again.
    pub item: String,
    /// Table, figure, equation or section.
    pub from: String,
    /// A remark on the print.
    #[serde(default)]
    pub note: Option<String>,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Their units, empty for a pure number.
    pub units: Vec<String>,
    /// The rows.
    pub rows: Vec<Row>,
}

/// A row of a table.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// Its name.
    pub name: String,
    /// Its values, by column.
    pub values: Vec<f64>,
}

/// A number from a sentence.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quoted {
    /// The item that computes it again.
    pub item: String,
    /// Where it stands.
    pub from: String,
    /// Of whom.
    pub row: String,
    /// Of what.
    pub column: String,
    /// Unit, empty for a pure number.
    pub unit: String,
    /// The number.
    pub value: f64,
    /// The sentence, shortened.
    pub words: String,
}

/// Heights of one run's gain sets (Tables I.1 and I.2).
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Heights {
    /// "I.1" or "I.2".
    pub table: String,
    /// Number of the run.
    pub run: u32,
    /// Forward speed \[m/s\].
    pub speed: f64,
    /// Neural delay \[ms\].
    pub delay_ms: f64,
    /// How garbled rows were recovered.
    #[serde(default)]
    pub recovered: Option<String>,
    /// The gain sets.
    pub rows: Vec<GainRow>,
}

/// One gain set and its height.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GainRow {
    /// Gains on roll (p, i, d, dd), then on steer.
    pub gains: [f64; 8],
    /// Variance accounted for \[%\].
    pub vaf: f64,
    /// Largest disturbance \[rad/s\], to 0.1; NaN where it can't be read.
    pub height: f64,
}

/// One printed number with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Row.
    pub row: String,
    /// Column.
    pub column: String,
    /// Unit.
    pub unit: String,
    /// The number; `None` where nothing is printed.
    pub printed: Option<f64>,
    /// Table, figure, equation or section.
    pub from: String,
}

static PUBLISHED: LazyLock<Published> = LazyLock::new(|| {
    let file = toml::from_str(include_str!("../../../data/thesis.toml"));
    file.unwrap_or_else(|e| panic!("data/thesis.toml: {e}"))
});

/// The embedded file.
pub fn published() -> &'static Published {
    &PUBLISHED
}

/// Every number printed for `item`, tables first, in the file's order; cells without a number too.
pub fn cells(item: &str) -> Vec<Cell> {
    let tables = published().table.iter().filter(|t| t.item == item).flat_map(|table| {
        table.rows.iter().flat_map(move |row| {
            row.values.iter().enumerate().map(move |(i, &value)| Cell {
                row: row.name.clone(),
                column: table.columns[i].clone(),
                unit: table.units[i].clone(),
                printed: Some(value).filter(|v| v.is_finite()),
                from: table.from.clone(),
            })
        })
    });
    let quoted = published().quoted.iter().filter(|q| q.item == item).map(|q| Cell {
        row: q.row.clone(),
        column: q.column.clone(),
        unit: q.unit.clone(),
        printed: Some(q.value),
        from: q.from.clone(),
    });
    tables.chain(quoted).collect()
}

/// Remarks on the print of `item`, and the sentences its numbers come from.
pub fn remarks(item: &str) -> Vec<String> {
    let tables = published().table.iter().filter(|t| t.item == item);
    let notes = tables.filter_map(|t| t.note.as_ref().map(|note| format!("{}: {note}.", t.from)));
    let quoted = published().quoted.iter().filter(|q| q.item == item);
    let words = quoted.map(|q| format!("{}: “{}”.", q.from, q.words));
    let mut all: Vec<String> = notes.chain(words).collect();
    all.dedup();
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_rectangular_and_items_are_known() {
        for table in &published().table {
            assert_eq!(table.columns.len(), table.units.len(), "{}", table.from);
            for row in &table.rows {
                assert_eq!(row.values.len(), table.columns.len(), "{} {}", table.from, row.name);
            }
        }
        let items =
            published().table.iter().map(|t| &t.item).chain(published().quoted.iter().map(|q| &q.item));
        for item in items {
            assert!(crate::thesis::catalogue::CATALOGUE.iter().any(|e| e.name == item), "{item}");
        }
    }
}
