//! The numbers printed in the thesis: `data/thesis.toml`.

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
    /// Run 249, which the smart cyclist's gains omit.
    pub run_249: Run249,
}

/// Run 249 of Tables G.4 and H.4.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Run249 {
    /// Forward speed \[m/s\].
    pub speed: f64,
    /// Variance accounted for \[%\].
    pub vaf: f64,
    /// Gains on roll (p, i, d, dd), then on steer, by Table G.4.
    pub table_g_4: [f64; 8],
    /// The same gains by Table H.4.
    pub table_h_4: [f64; 8],
}

/// A number as printed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Printed {
    /// The number.
    pub value: f64,
    /// Half a unit of its last digit: the largest rounding error.
    pub rounding: f64,
}

impl Printed {
    /// Parses a number and counts its digits.
    ///
    /// # Errors
    /// The text is no number.
    pub fn parse(text: &str) -> Result<Self, std::num::ParseFloatError> {
        let decimals = text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        Ok(Self { value: text.parse()?, rounding: 0.5 * 10f64.powi(-(decimals as i32)) })
    }
}

/// A text that is a printed number, or empty.
fn cell_text<'de, D: serde::Deserializer<'de>>(from: D) -> Result<Option<Printed>, D::Error> {
    let text = String::deserialize(from)?;
    let wrong = |e| serde::de::Error::custom(format!("`{text}`: {e}"));
    if text.is_empty() { Ok(None) } else { Printed::parse(&text).map(Some).map_err(wrong) }
}

/// A cell of a table in the file.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(transparent)]
pub struct CellText(#[serde(deserialize_with = "cell_text")] pub Option<Printed>);

/// A one-sided statement about a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Bound {
    /// The true value is higher.
    Above,
    /// The true value is lower.
    Below,
}

/// A table of numbers.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// The item that reproduces it.
    pub item: String,
    /// Table, figure, equation or section.
    pub from: String,
    /// A remark on the print.
    #[serde(default)]
    pub note: Option<String>,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Their units; empty for a pure number.
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
    pub values: Vec<CellText>,
}

/// A number from a sentence.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quoted {
    /// The item that reproduces it.
    pub item: String,
    /// Where it is printed.
    pub from: String,
    /// Row: the subject of the number.
    pub row: String,
    /// Column: the quantity.
    pub column: String,
    /// Unit; empty for a pure number.
    pub unit: String,
    /// The number.
    pub value: CellText,
    /// The sentence, shortened.
    pub words: String,
    /// Whether only a bound is printed.
    #[serde(default)]
    pub bound: Option<Bound>,
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
    /// How illegible rows were recovered.
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
    /// Largest disturbance \[rad/s\], to 0.1; NaN where it is illegible.
    pub height: f64,
}

/// One printed number with its position.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Row.
    pub row: String,
    /// Column.
    pub column: String,
    /// Unit.
    pub unit: String,
    /// The number; `None` if none is printed.
    pub printed: Option<Printed>,
    /// Whether only a bound is printed.
    pub bound: Option<Bound>,
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

/// The height of gain set `number`, from 1, of a run in Table I.1 or I.2, which print it "± 0.1".
pub fn height_cell(of: &Heights, number: usize) -> Cell {
    let height = of.rows.get(number - 1).map_or(f64::NAN, |row| row.height);
    Cell {
        row: format!("run {}, set {number}", of.run),
        column: "height".into(),
        unit: "rad/s".into(),
        printed: height.is_finite().then_some(Printed { value: height, rounding: 0.1 }),
        bound: None,
        from: format!("Table {}", of.table),
    }
}

/// Every number printed for `item`, tables first, in the file's order; cells without a number included.
pub fn cells(item: &str) -> Vec<Cell> {
    let heights = published().height.iter().filter(|h| item.strip_prefix("table-") == Some(&h.table));
    let heights = heights.flat_map(|h| (1..=h.rows.len()).map(move |number| height_cell(h, number)));
    let tables = published().table.iter().filter(|t| t.item == item).flat_map(|table| {
        table.rows.iter().flat_map(move |row| {
            row.values.iter().enumerate().map(move |(i, value)| Cell {
                row: row.name.clone(),
                column: table.columns[i].clone(),
                unit: table.units[i].clone(),
                printed: value.0,
                bound: None,
                from: table.from.clone(),
            })
        })
    });
    let quoted = published().quoted.iter().filter(|q| q.item == item).map(|q| Cell {
        row: q.row.clone(),
        column: q.column.clone(),
        unit: q.unit.clone(),
        printed: q.value.0,
        bound: q.bound,
        from: q.from.clone(),
    });
    heights.chain(tables).chain(quoted).collect()
}

/// Remarks on the print of `item`, and the sentences that contain its numbers.
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
