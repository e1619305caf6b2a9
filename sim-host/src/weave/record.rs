//! Reads a recording: a CSV file with a column of times and columns of rates. Faulty lines are listed and
//! left out.

use crate::recording::cut_line;
use crate::recording::stamp::seconds;
pub use analysis::weave::record::{Axis, Record};
use csv::StringRecord;

/// Names of time columns searched for by default.
pub const TIMES: [&str; 4] = ["Time", "time", "t", "time_s"];
/// Names of rate columns searched for by default: roll and yaw. The pitch rate of a weaving bicycle is of
/// second order, with twice the frequency, and mostly vibration.
pub const RATES: [&str; 2] = ["gyro_x", "gyro_z"];
/// Largest accepted magnitude of a rate \[rad/s\].
pub const LARGEST_RAD_S: f64 = 50.0;
/// Largest number of lines listed for one type of fault.
const LISTED: usize = 3;

/// Unit of the rates in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Unit {
    /// rad/s.
    #[default]
    Radian,
    /// deg/s.
    Degree,
}

impl Unit {
    /// One unit in rad/s.
    pub fn rad_s(self) -> f64 {
        match self {
            Unit::Radian => 1.0,
            Unit::Degree => 1.0_f64.to_radians(),
        }
    }
}

/// Columns to read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Columns {
    /// Column of times; by default one of [`TIMES`].
    pub time: Option<String>,
    /// Columns of rates; by default those of [`RATES`] that the file has.
    pub rates: Vec<String>,
    /// Their unit.
    pub unit: Unit,
}

/// A usable line.
struct Row {
    line: u64,
    stamp: String,
    time_s: f64,
    rates: Vec<f64>,
}

/// A text that is no recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// Not a table.
    #[error(transparent)]
    Csv(#[from] csv::Error),
    /// A column listed twice.
    #[error("line 1: column `{0}` is listed twice")]
    Twice(String),
    /// A missing column.
    #[error("line 1: column {column} is missing; there are {known}")]
    Missing {
        /// The column.
        column: String,
        /// The columns that there are.
        known: String,
    },
    /// No usable line.
    #[error("no line can be used{}", notes.iter().map(|note| format!("; {note}")).collect::<String>())]
    NoLine {
        /// The faults of the lines.
        notes: Vec<String>,
    },
}

/// Reads a recording from text.
///
/// # Errors
/// A column is missing or duplicate, or no line is usable.
pub fn read(text: &str, columns: &Columns) -> Result<Record, RecordError> {
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .flexible(true)
        .from_reader(text.trim_start_matches('\u{feff}').as_bytes());
    let header = reader.headers()?.clone();
    let time = time_column(&header, columns)?;
    let axes = rate_columns(&header, columns)?;
    let mut notes = Notes::default();
    let mut rows: Vec<Row> = Vec::new();
    for record in reader.records() {
        let record = record?;
        let line = record.position().map_or(0, csv::Position::line);
        match row(&header, &record, line, time, &axes, columns.unit) {
            Ok(row) => rows.push(row),
            Err((kind, error)) => notes.add(kind, line, &error),
        }
    }
    let rows = rising(rows, &header[time], &mut notes);
    let mut notes = notes.listed();
    if let Some(cut) = cut_line(text).filter(|cut| rows.last().map(|row| row.line) == cut.line) {
        notes.push(cut.to_string());
    }
    if rows.is_empty() {
        return Err(RecordError::NoLine { notes });
    }
    let begin = rows[0].time_s;
    let axis = |(i, place): (usize, &usize)| Axis {
        column: header[*place].to_owned(),
        rates_rad_s: rows.iter().map(|row| row.rates[i]).collect(),
    };
    Ok(Record {
        times_s: rows.iter().map(|row| row.time_s - begin).collect(),
        axes: axes.iter().enumerate().map(axis).collect(),
        notes,
    })
}

fn place(header: &StringRecord, name: &str) -> Result<Option<usize>, RecordError> {
    let mut found = header.iter().enumerate().filter(|(_, h)| *h == name).map(|(i, _)| i);
    match (found.next(), found.next()) {
        (at, None) => Ok(at),
        _ => Err(RecordError::Twice(name.into())),
    }
}

fn missing(header: &StringRecord, column: &str) -> RecordError {
    RecordError::Missing { column: column.into(), known: header.iter().collect::<Vec<_>>().join(", ") }
}

fn time_column(header: &StringRecord, columns: &Columns) -> Result<usize, RecordError> {
    if let Some(name) = &columns.time {
        return place(header, name)?.ok_or_else(|| missing(header, &format!("`{name}`")));
    }
    for name in TIMES {
        if let Some(at) = place(header, name)? {
            return Ok(at);
        }
    }
    Err(missing(header, "`Time` (or --time-column)"))
}

fn rate_columns(header: &StringRecord, columns: &Columns) -> Result<Vec<usize>, RecordError> {
    if columns.rates.is_empty() {
        let there =
            RATES.iter().filter_map(|name| place(header, name).transpose()).collect::<Result<Vec<_>, _>>()?;
        return if there.is_empty() { Err(missing(header, "`gyro_x` (or --column)")) } else { Ok(there) };
    }
    let named = columns.rates.iter();
    named.map(|name| place(header, name)?.ok_or_else(|| missing(header, &format!("`{name}`")))).collect()
}

/// Types of faults in a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Short,
    Stamp,
    Rate,
    Back,
}

fn row(
    header: &StringRecord,
    record: &StringRecord,
    line: u64,
    time: usize,
    axes: &[usize],
    unit: Unit,
) -> Result<Row, (Kind, String)> {
    if record.len() != header.len() {
        return Err((Kind::Short, format!("{} fields, but the heading has {}", record.len(), header.len())));
    }
    let stamp = record[time].to_owned();
    let wrong = || format!("`{}` = `{stamp}` is neither seconds nor a date with a time", &header[time]);
    let time_s = seconds(&stamp).ok_or_else(|| (Kind::Stamp, wrong()))?;
    let most = LARGEST_RAD_S / unit.rad_s();
    let rate = |place: &usize| {
        let value = record[*place].parse::<f64>().ok().filter(|x| x.abs() <= most);
        value.map(|x| x * unit.rad_s()).ok_or_else(|| {
            let unit = if unit == Unit::Degree { "deg/s" } else { "rad/s" };
            let (column, cell) = (&header[*place], &record[*place]);
            (Kind::Rate, format!("`{column}` = `{cell}` is not a number from -{most:.0} to {most:.0} {unit}"))
        })
    };
    Ok(Row { line, time_s, rates: axes.iter().map(rate).collect::<Result<_, _>>()?, stamp })
}

/// The rows with increasing times. A single time that is later than the two after it is left out.
fn rising(rows: Vec<Row>, column: &str, notes: &mut Notes) -> Vec<Row> {
    let mut accepted: Vec<Row> = Vec::with_capacity(rows.len());
    let mut rows = rows.into_iter().peekable();
    while let Some(row) = rows.next() {
        if let [.., before, last] = &accepted[..]
            && (before.time_s..last.time_s).contains(&row.time_s)
            && row.time_s > before.time_s
            && rows.peek().is_some_and(|next| next.time_s < last.time_s)
        {
            let (line, stamp) = (last.line, &last.stamp);
            notes.add(Kind::Back, line, &format!("`{column}` = `{stamp}` is later than the next lines'"));
            accepted.pop();
        }
        match accepted.last() {
            Some(last) if row.time_s <= last.time_s => {
                let how = if row.time_s == last.time_s { "stands" } else { "goes back" };
                let (stamp, before) = (&row.stamp, &last.stamp);
                notes.add(Kind::Back, row.line, &format!("`{column}` {how}: `{stamp}` after `{before}`"));
            }
            _ => accepted.push(row),
        }
    }
    accepted
}

/// Faulty lines, by type.
#[derive(Default)]
struct Notes(Vec<(Kind, u64, String)>);

impl Notes {
    fn add(&mut self, kind: Kind, line: u64, error: &str) {
        self.0.push((kind, line, format!("line {line}: {error}; left out")));
    }

    /// The first lines of each type, and the number of further ones.
    fn listed(mut self) -> Vec<String> {
        self.0.sort_by_key(|(kind, line, _)| (*kind, *line));
        let groups = self.0.chunk_by(|a, b| a.0 == b.0);
        let listed = groups.flat_map(|group| {
            let more = group.len().saturating_sub(LISTED);
            let more = (more > 0).then(|| format!("{more} more lines like line {}; left out", group[0].1));
            group.iter().take(LISTED).map(|(_, _, error)| error.clone()).chain(more)
        });
        listed.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<Record, RecordError> {
        read(text, &Columns::default())
    }

    fn error(text: &str) -> String {
        of(text).unwrap_err().to_string()
    }

    #[test]
    fn faulty_lines_are_listed_and_the_others_are_used() {
        let text = "# a comment\nTime,gyro_x,gyro_y\n0,1,0\n0.1,2,0\n0.1,3,0\n0.05,4,0\n0.2,nan,0\n0.3,5,0\n9.0,6,0\n0.4,7,0\n\
                    0.45,9,0\n0.5,60,0\nnow,1,0\n0.6,8";
        let record = of(text).unwrap();
        assert_eq!(record.axes.len(), 1);
        assert_eq!(record.axes[0].rates_rad_s, [1.0, 2.0, 5.0, 7.0, 9.0]);
        assert_eq!(record.times_s, [0.0, 0.1, 0.3, 0.4, 0.45]);
        let expected = [
            "line 14: 2 fields, but the heading has 3; left out",
            "line 13: `Time` = `now` is neither seconds nor a date with a time; left out",
            "line 7: `gyro_x` = `nan` is not a number from -50 to 50 rad/s; left out",
            "line 12: `gyro_x` = `60` is not a number from -50 to 50 rad/s; left out",
            "line 5: `Time` stands: `0.1` after `0.1`; left out",
            "line 6: `Time` goes back: `0.05` after `0.1`; left out",
            "line 9: `Time` = `9.0` is later than the next lines'; left out",
        ];
        assert_eq!(record.notes, expected);
    }

    #[test]
    fn columns_are_found_by_name() {
        let degrees = Columns { time: Some("s".into()), rates: vec!["r".into()], unit: Unit::Degree };
        let record = read("s,r\n2,180\n3,-90\n", &degrees).unwrap();
        assert_eq!(record.times_s, [0.0, 1.0]);
        assert!((record.axes[0].rates_rad_s[0] - std::f64::consts::PI).abs() < 1e-12);
        assert!(
            error("x,gyro_x\n1,2\n").contains("`Time` (or --time-column) is missing; there are x, gyro_x")
        );
        assert!(error("t,x\n1,2\n").contains("`gyro_x` (or --column) is missing"));
        assert!(error("t,gyro_x,gyro_x\n1,2,3\n").contains("`gyro_x` is listed twice"));
        assert!(error("t,gyro_x\n").contains("no line can be used"));
    }
}
