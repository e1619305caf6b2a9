//! Parses the axes of a sweep: `KEY=VALUES` with words and ranges of numbers.

use crate::scenario::setting::{self, Setting};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Largest number of values of one axis.
const MOST: usize = 1000;

/// A varied option or placeholder, and its values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Axis {
    /// Long name of an option, or the placeholder in braces in an option's value.
    pub key: String,
    /// Values, as on the command line.
    pub values: Vec<String>,
}

/// A text that is no axis.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AxisError {
    /// Not a key and its values.
    #[error("`{0}` is not KEY=VALUES, for example torque-limit=0.5:20/log9,none")]
    Form(String),
    /// A wrong value or range.
    #[error("{key}: {error}")]
    Item {
        /// The key.
        key: String,
        /// The error.
        error: ItemError,
    },
    /// A value listed twice.
    #[error("{key}: `{value}` is listed twice")]
    Twice {
        /// The key.
        key: String,
        /// The value.
        value: String,
    },
    /// Two forms of one value.
    #[error("{key}: `{first}` and `{second}` are equal: listed twice")]
    Equal {
        /// The key.
        key: String,
        /// The first form.
        first: String,
        /// The second form.
        second: String,
    },
    /// Too many values.
    #[error("{key} has {values} values; at most {MOST}")]
    Many {
        /// The key.
        key: String,
        /// The number of values.
        values: usize,
    },
}

impl AxisError {
    /// Key of the axis, if there is one.
    pub fn key(&self) -> Option<&str> {
        match self {
            Self::Form(_) => None,
            Self::Item { key, .. }
            | Self::Twice { key, .. }
            | Self::Equal { key, .. }
            | Self::Many { key, .. } => Some(key),
        }
    }
}

/// A wrong value or range of an axis; each with the range as given.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ItemError {
    /// Nothing between two commas.
    #[error("a value is empty")]
    Empty,
    /// Different units.
    #[error("the range {0} has several units")]
    Units(String),
    /// Another form.
    #[error("the range {0} is none of A:B:STEP, A:B/N, A:B/logN")]
    Form(String),
    /// A falling range, or a step too small.
    #[error("the range {0} must rise, in steps of at least 0.000001")]
    Steps(String),
    /// A falling range.
    #[error("the range {0} must rise")]
    Falling(String),
    /// Too many values.
    #[error("the range {0} has more than {MOST} values")]
    Many(String),
    /// A wrong number of values.
    #[error("the range {range}: `{count}` is not a whole number of values from 2 to {MOST}")]
    Count {
        /// The range.
        range: String,
        /// The number as given.
        count: String,
    },
    /// A logarithmic range from zero or below.
    #[error("the range {0}: a logarithmic range begins above 0")]
    Logarithm(String),
}

impl Axis {
    /// Parses `KEY=VALUES`: words and ranges, separated by commas. `A:B:STEP` and `A:B/N` are evenly spaced,
    /// `A:B/logN` evenly in the logarithm; numbers can have a unit, as in `0ms:100ms/6`. A comma inside a
    /// value is written with a backslash before it.
    ///
    /// # Errors
    /// States the range or word and the fault.
    pub fn parse(text: &str) -> Result<Self, AxisError> {
        let wrong = || AxisError::Form(text.into());
        let (key, list) = text.split_once('=').ok_or_else(wrong)?;
        if !key.starts_with(char::is_alphabetic)
            || !key.chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c))
        {
            return Err(wrong());
        }
        let mut values: Vec<String> = Vec::new();
        for item in items(list) {
            for value in expand(item.trim()).map_err(|error| AxisError::Item { key: key.into(), error })? {
                if let Some(same) = values.iter().find(|other| equal(other, &value)) {
                    let key = key.into();
                    return Err(match *same == value {
                        true => AxisError::Twice { key, value },
                        false => AxisError::Equal { key, first: same.clone(), second: value },
                    });
                }
                values.push(value);
            }
        }
        if values.len() > MOST {
            return Err(AxisError::Many { key: key.into(), values: values.len() });
        }
        Ok(Self { key: key.into(), values })
    }

    /// The values as numbers of one unit; `None` if they are not.
    pub fn numbers(&self) -> Option<(Vec<f64>, &str)> {
        let all: Vec<(f64, &str)> = self.values.iter().map(|v| number(v)).collect::<Option<_>>()?;
        let (_, unit) = *all.first()?;
        if all.iter().all(|(_, u)| *u == unit) {
            return Some((all.iter().map(|(x, _)| *x).collect(), unit));
        }
        let seconds = all.iter().map(|&(x, unit)| seconds(x, unit)).collect::<Option<_>>()?;
        Some((seconds, "s"))
    }
}

impl Axis {
    /// The unit of an axis of numbers, the option's if none is typed; `None` for an axis of words.
    pub fn unit(&self) -> Option<AxisUnit<'_>> {
        let (_, typed) = self.numbers()?;
        let (column, netcdf) = match typed {
            "" => self.setting().and_then(Setting::unit).unwrap_or(("", "1")),
            "deg" => ("deg", "degree"),
            typed => (typed, typed),
        };
        Some(AxisUnit { netcdf, column })
    }

    /// What the axis is, in a few words: those of its setting, or its placeholder.
    pub fn about(&self) -> String {
        self.setting().map_or_else(|| self.key.replace('-', " "), Setting::about)
    }

    fn setting(&self) -> Option<&'static Setting> {
        setting::of_name(&self.key)
    }

    /// One of the values as a number in the axis's unit; `None` for an axis of words.
    pub(super) fn number_of(&self, value: &str) -> Option<f64> {
        let (numbers, _) = self.numbers()?;
        let place = self.values.iter().position(|v| v == value)?;
        numbers.get(place).copied()
    }
}

/// The unit of an axis of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisUnit<'a> {
    /// As UDUNITS writes it; `1` if unknown or without one.
    pub netcdf: &'a str,
    /// As the end of a column's name; may be empty.
    pub column: &'a str,
}

/// A time in seconds, from its unit.
fn seconds(x: f64, unit: &str) -> Option<f64> {
    match unit {
        "ms" => Some(x / 1e3),
        "s" => Some(x),
        _ => None,
    }
}

/// Whether two values are equal in each of their parts, as in `0.5:1.5` or `gyro:stuck@0.3s`.
fn equal(a: &str, b: &str) -> bool {
    let [a, b] = [a, b].map(|text| text.replace("..", ":"));
    let parts = |text: &'_ str| text.split([':', '=', ',', '@']).map(str::to_owned).collect::<Vec<_>>();
    let (a, b) = (parts(&a), parts(&b));
    a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| same(a, b))
}

/// Whether two parts are the same word, number or time.
fn same(a: &str, b: &str) -> bool {
    let (Some((x, u)), Some((y, w))) = (number(a), number(b)) else { return a == b };
    if u == w { x == y } else { seconds(x, u).is_some_and(|x| Some(x) == seconds(y, w)) }
}

/// Splits a list at commas, except those with a backslash before them.
fn items(list: &str) -> Vec<String> {
    let mut items = vec![String::new()];
    let mut letters = list.chars().peekable();
    while let Some(letter) = letters.next() {
        let item = items.last_mut();
        match (letter, item) {
            ('\\', Some(item)) if letters.peek() == Some(&',') => item.extend(letters.next()),
            (',', _) => items.push(String::new()),
            (letter, Some(item)) => item.push(letter),
            (_, None) => {}
        }
    }
    items
}

/// Splits a text into a number and its unit; `None` for other text.
fn number(text: &str) -> Option<(f64, &str)> {
    // Otherwise `inf`, `nan` and words that begin so would parse as numbers.
    if !text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) {
        return None;
    }
    let ends = (1..=text.len()).rev().filter(|&end| text.is_char_boundary(end));
    let (x, unit) = ends.filter_map(|end| Some((text[..end].parse::<f64>().ok()?, &text[end..]))).next()?;
    (x.is_finite() && unit.chars().all(char::is_alphabetic)).then_some((x, unit))
}

/// Values of an item of the list: the values of a range, otherwise the item itself.
fn expand(item: &str) -> Result<Vec<String>, ItemError> {
    if item.is_empty() {
        return Err(ItemError::Empty);
    }
    let (ends, count) = match item.split_once('/') {
        Some((ends, count)) => (ends, Some(count)),
        None => (item, None),
    };
    let Some(parts) = ends.split(':').map(number).collect::<Option<Vec<_>>>() else {
        return Ok(vec![item.into()]);
    };
    let unit = parts.iter().map(|p| p.1).find(|u| !u.is_empty()).unwrap_or_default();
    if parts.iter().any(|p| !p.1.is_empty() && p.1 != unit) {
        return Err(ItemError::Units(item.into()));
    }
    let points = match (&parts[..], count) {
        (&[(from, _), (to, _), (step, _)], None) => stepped(item, from, to, step)?,
        (&[(from, _), (to, _)], Some(count)) => counted(item, from, to, count)?,
        (_, None) => return Ok(vec![item.into()]),
        _ => return Err(ItemError::Form(item.into())),
    };
    Ok(points.into_iter().map(|x| format!("{}{unit}", x + 0.0)).collect())
}

fn stepped(item: &str, from: f64, to: f64, step: f64) -> Result<Vec<f64>, ItemError> {
    if step < 1e-6 || to < from {
        return Err(ItemError::Steps(item.into()));
    }
    let n = ((to - from) / step + 1e-9).floor();
    if n >= MOST as f64 {
        return Err(ItemError::Many(item.into()));
    }
    Ok((0..=n as usize).map(|i| billionths(from + i as f64 * step)).collect())
}

fn counted(item: &str, from: f64, to: f64, count: &str) -> Result<Vec<f64>, ItemError> {
    let (log, digits) = count.strip_prefix("log").map_or((false, count), |n| (true, n));
    let n = digits
        .parse()
        .ok()
        .filter(|n| (2..=MOST).contains(n))
        .ok_or_else(|| ItemError::Count { range: item.into(), count: digits.into() })?;
    if to <= from {
        return Err(ItemError::Falling(item.into()));
    }
    if log && from <= 0.0 {
        return Err(ItemError::Logarithm(item.into()));
    }
    let at = |i: usize| match (i as f64 / (n - 1) as f64, log) {
        _ if i == 0 => from,
        _ if i == n - 1 => to,
        (part, true) => four_digits(from * libm::pow(to / from, part)),
        (part, false) => billionths(from + part * (to - from)),
    };
    Ok((0..n).map(at).collect())
}

/// Rounds to 1e-9, so that steps of 0.1 give 0.3 and not 0.30000000000000004.
fn billionths(x: f64) -> f64 {
    (x * 1e9).round() / 1e9
}

/// Rounds to four digits; values on a logarithmic axis need not be exact.
fn four_digits(x: f64) -> f64 {
    format!("{x:.3e}").parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Vec<String> {
        Axis::parse(text).unwrap().values
    }

    #[test]
    fn ranges_and_texts_mix() {
        assert_eq!(values("torque-limit=0.5:20/log4,none"), ["0.5", "1.71", "5.848", "20", "none"]);
        assert_eq!(values("sensor-delay=0ms:100ms/6"), ["0ms", "20ms", "40ms", "60ms", "80ms", "100ms"]);
        assert_eq!(values("sensor-delay=0:0.3:0.1s"), ["0s", "0.1s", "0.2s", "0.3s"]);
        assert_eq!(values("taper=none,0.5:1.5"), ["none", "0.5:1.5"]);
        assert_eq!(values("law=h,cl2:4,data/laws/example.toml"), ["h", "cl2:4", "data/laws/example.toml"]);
        assert_eq!(values(r"law=h,a\,b.toml"), ["h", "a,b.toml"]);
        assert_eq!(values("fault=gyro:stuck@0.3s,gyro:stuck@3s"), ["gyro:stuck@0.3s", "gyro:stuck@3s"]);
        assert_eq!(values("set=shape.rate=3"), ["shape.rate=3"]);
    }

    #[test]
    fn numbers_have_one_unit() {
        let numbers = |text: &str| Axis::parse(text).unwrap().numbers().map(|(n, u)| (n, u.to_owned()));
        assert_eq!(numbers("a=0ms,20ms"), Some((vec![0.0, 20.0], "ms".into())));
        assert_eq!(numbers("a=1e3,-2"), Some((vec![1e3, -2.0], String::new())));
        assert_eq!(numbers("a=500ms,1s"), Some((vec![0.5, 1.0], "s".into())));
        for text in ["a=0ms,1", "a=1,none", "a=inf", "a=nan", "a=0.5:1.5"] {
            assert_eq!(numbers(text), None, "{text}");
        }
    }

    #[test]
    fn invalid_axes_are_rejected_with_the_reason() {
        for (text, expected) in [
            ("torque-limit", "KEY=VALUES"),
            ("=1", "KEY=VALUES"),
            ("a b=1", "KEY=VALUES"),
            ("a=", "empty"),
            ("a=1,,2", "empty"),
            ("a=1,1", "twice"),
            ("a=1,1.0", "are equal"),
            ("a=20ms,0.02s", "are equal"),
            ("taper=0.5:1.5,0.50:1.5", "are equal"),
            ("law=cl2:3,cl2:3.0", "are equal"),
            ("fault=gyro:stuck@300ms..1s,gyro:stuck@0.3s..1s", "are equal"),
            ("a=0:1:0.5,5e-1", "are equal"),
            ("a=1:0:0.1", "must rise"),
            ("a=0:1:0", "must rise"),
            ("a=1:1/3", "must rise"),
            ("a=0:1/log3", "above 0"),
            ("a=0:1/1", "2 to 1000"),
            ("a=0:1/x", "`x`"),
            ("a=0:1:0.1/3", "none of"),
            ("a=0ms:1s/3", "several units"),
            ("a=0:1:1e-5", "more than 1000"),
        ] {
            let error = Axis::parse(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}
