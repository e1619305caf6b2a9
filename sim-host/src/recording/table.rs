//! Reads a table of samples as text: named columns, one row per line, blank cells where a sensor had no new sample.
//!
//! The separator is the most frequent of comma, semicolon and tab in the header. Lines that begin with `#` are
//! comments. Each line is parsed on its own, so that a stray quote or a cut line affects that line only.

use super::remarks::Remarks;
use super::stamp::seconds;
use super::{Column, Group, Recording, Remark};

/// Remark for rows whose length differs from the header's.
const LENGTH: &str = "rows of another length than the header; left out";
/// Remark for cells that are no number.
const NUMBER: &str = "cells that are no number; taken as blank";
/// Remark for further headers.
const HEADER: &str = "lines that name other columns; from there on the new ones are used";
/// Remark for bytes that are no text.
const PACKED: &str = "lines with bytes that are no text; left out";

/// Parses a table. Unusable rows and cells become remarks; the rest is the recording.
///
/// # Errors
/// No header with names, or no row after it.
pub fn parse(text: &str) -> Result<Recording, Remark> {
    let fails = |line: Option<u64>, what: &str| Remark { line, column: None, what: what.to_owned() };
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = text
        .lines()
        .zip(1_u64..)
        .map(|(line, number)| (line.trim_end_matches('\r'), number))
        .filter(|(line, _)| !line.trim().is_empty() && !line.starts_with('#'));
    let Some((header, at)) = lines.next() else {
        return Err(fails(None, "the file has no line with data"));
    };
    let header = Header::parse(header).map_err(|what| fails(Some(at), &what))?;
    let separator = header.separator;

    let mut columns: Vec<Column> =
        header.names.iter().map(|name| Column { name: name.clone(), ..Column::default() }).collect();
    // Column of each field of the current lines.
    let mut places: Vec<usize> = (0..columns.len()).collect();
    let (mut numbers, mut remarks) = (Vec::new(), Remarks::default());
    let ends_whole = text.ends_with('\n');
    let last = text.lines().count() as u64;
    for (line, number) in lines {
        let line = header.open(line);
        if line.contains('\u{fffd}') || line.contains('\0') {
            remarks.add(PACKED, Some(number), None, || "has bytes that are no text; left out".to_owned());
            continue;
        }
        if let Some(new) = names_of(line, separator) {
            remarks.add(HEADER, Some(number), None, || {
                format!("names {} other columns; from here on these are used", new.len())
            });
            places = new.iter().map(|name| place_of(&mut columns, name, numbers.len())).collect();
            continue;
        }
        let fields: Vec<&str> = line.split(separator).map(str::trim).collect();
        if fields.len() != places.len() {
            let cut = number == last && !ends_whole;
            remarks.add(LENGTH, Some(number), None, || {
                let half = if cut { ", the file ends within it" } else { "" };
                format!("{} fields, the header has {}{half}; left out", fields.len(), places.len())
            });
            continue;
        }
        columns.iter_mut().for_each(|column| column.values.push(f64::NAN));
        numbers.push(number);
        for (place, field) in places.iter().zip(fields) {
            let column = &mut columns[*place];
            if is_blank(field) {
                continue;
            }
            match number_of(field).or_else(|| with_comma(field, separator)) {
                Some(value) => *column.values.last_mut().expect("a row") = value,
                None => remarks.add(NUMBER, Some(number), Some(&column.name), || {
                    format!("`{}` is no number; taken as blank", shown(field))
                }),
            }
        }
    }
    if numbers.is_empty() {
        return Err(remarks
            .done()
            .into_iter()
            .next()
            .unwrap_or(fails(Some(at), "there is no row below the header")));
    }
    let group = Group { name: String::new(), times_s: None, lines: numbers, columns };
    Ok(Recording { groups: vec![group], remarks: remarks.done() })
}

/// A header line.
struct Header {
    separator: char,
    /// Whether a separator follows the last column, which some loggers write.
    closed: bool,
    names: Vec<String>,
}

impl Header {
    /// Parses a header, or says what is wrong with it.
    fn parse(line: &str) -> Result<Self, String> {
        let separator = separator_of(line);
        if line.contains('\0') {
            return Err("is no text in UTF-8".into());
        }
        let line = line.trim_end();
        let unnamed = Self { separator, closed: line.ends_with(separator), names: Vec::new() };
        let line = unnamed.open(line);
        let names = names_of(line, separator).ok_or_else(|| {
            let line = shown(line);
            format!("a header with the columns' names was expected, not `{line}`; add one line with names")
        })?;
        match names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)) {
            Some((_, twice)) => Err(format!("two columns are called `{twice}`")),
            None => Ok(Self { names, ..unnamed }),
        }
    }

    /// A line without the separator after its last column.
    fn open<'a>(&self, line: &'a str) -> &'a str {
        let shorter = line.trim_end_matches(' ');
        shorter.strip_suffix(self.separator).filter(|_| self.closed).unwrap_or(shorter)
    }
}

/// The separator of a line: the most frequent of comma, semicolon and tab.
fn separator_of(line: &str) -> char {
    let count = |separator: &char| line.matches(*separator).count();
    [',', ';', '\t'].into_iter().rev().max_by_key(count).unwrap_or(',')
}

/// The names in a line, if it is a header: at least one field, and none of them a number.
fn names_of(line: &str, separator: char) -> Option<Vec<String>> {
    let names: Vec<String> =
        line.split(separator).map(|name| name.trim().trim_matches('"').to_owned()).collect();
    let named = |name: &String| !name.is_empty() && number_of(name).is_none() && !is_blank(name);
    let starts_a_name =
        |name: &String| name.chars().next().is_some_and(|c| c.is_alphabetic() || c == '_' || c == '/');
    (names.iter().all(named) && names.iter().all(starts_a_name)).then_some(names)
}

/// The index of a column; a new one has no value in earlier rows.
fn place_of(columns: &mut Vec<Column>, name: &str, rows: usize) -> usize {
    columns.iter().position(|column| column.name == name).unwrap_or_else(|| {
        columns.push(Column { name: name.to_owned(), values: vec![f64::NAN; rows], ..Column::default() });
        columns.len() - 1
    })
}

/// Whether a field means "no value".
fn is_blank(field: &str) -> bool {
    field.is_empty() || ["nan", "null", "none", "na", "-"].iter().any(|word| field.eq_ignore_ascii_case(word))
}

/// A number, or a date with a time of day in seconds since 1970; on and off are 1 and 0.
fn number_of(field: &str) -> Option<f64> {
    let field = field.trim_matches('"');
    match field {
        "true" | "on" | "True" => return Some(1.0),
        "false" | "off" | "False" => return Some(0.0),
        _ => {}
    }
    seconds(field)
}

/// A number with a decimal comma, if the comma is not the separator.
fn with_comma(field: &str, separator: char) -> Option<f64> {
    let one = separator != ',' && field.matches(',').count() == 1 && !field.contains('.');
    one.then(|| number_of(&field.replace(',', "."))).flatten()
}

/// A field for a message, shortened to fit a line.
fn shown(field: &str) -> String {
    let short: String = field.chars().take(24).collect();
    if short.len() < field.len() { short + "..." } else { short }
}
