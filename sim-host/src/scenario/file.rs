//! Scenario files: TOML, or JSON, which can also be a result that contains its scenario.

use super::{Scenario, ScenarioError};
use serde::Deserialize;
use std::path::Path;
use toml::Value;

impl Scenario {
    /// Reads a scenario from a file, or from standard input (`-`): JSON if it begins with a brace or its name ends in `.json`, otherwise TOML. Of a
    /// result of `ride`, `basin` or `basin plane`, the scenario in it.
    ///
    /// # Errors
    /// States file, line or key, and what was expected.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let text = match path.to_str() {
            Some("-") => std::io::read_to_string(std::io::stdin()),
            _ => std::fs::read_to_string(path),
        };
        let text = text.map_err(|source| ScenarioError::Read { path: path.into(), source })?;
        let text = text.trim_start_matches('\u{feff}');
        let json = text.trim_start().starts_with('{')
            || path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
        let read = if json { Self::from_json(text) } else { Self::from_toml(text) };
        read.map_err(|reason| ScenarioError::Syntax { path: path.into(), reason })
    }

    /// Parses a scenario in TOML.
    ///
    /// # Errors
    /// States line, key and what was expected.
    pub fn from_toml(text: &str) -> Result<Self, String> {
        toml::from_str(text).map_err(|e| in_plain_words(e.to_string().trim()))
    }

    /// Parses a scenario in JSON, or the scenario of a result.
    ///
    /// # Errors
    /// States line or key, and what was expected.
    pub fn from_json(text: &str) -> Result<Self, String> {
        let value: serde_json::Value = serde_json::from_str(text).map_err(|e| e.to_string())?;
        let Some(Value::Table(mut table)) = of_json(value) else {
            return Err("expected an object".into());
        };
        // Every document with a scenario in it has its configuration beside it.
        let of_result = table.contains_key("tool") || table.contains_key("config");
        let own = match table.remove("scenario") {
            Some(own) if of_result => own,
            Some(_) => return Err("`scenario` is a key of results only".into()),
            None if table.contains_key("cells") => {
                return Err("the scenarios are in `cells[i].scenario`".into());
            }
            None if table.contains_key("cases") => {
                return Err("the scenarios are in `cases[i].scenario`".into());
            }
            None if of_result => return Err("this result has no `scenario`".into()),
            None => Value::Table(table),
        };
        Self::deserialize(own).map_err(|e| in_plain_words(e.to_string().trim()))
    }

    /// The scenario as a TOML file.
    ///
    /// # Errors
    /// A number that TOML does not have: a seed above 2^63 - 1, which only code can set.
    pub fn to_toml(&self) -> Result<String, String> {
        toml::to_string(self).map_err(|e| e.to_string())
    }
}

/// A parser's message without the names of Rust's types.
fn in_plain_words(message: &str) -> String {
    let words: Vec<String> = message.split(' ').map(str::to_owned).collect();
    let mut plain: Vec<&str> = Vec::with_capacity(words.len());
    let mut words = words.iter().map(String::as_str).peekable();
    while let Some(word) = words.next() {
        plain.push(match word.trim_end() {
            "f64" => "a number",
            "u64" | "u32" | "usize" => "a whole number from 0",
            "struct" => {
                words.next();
                "a table"
            }
            "sequence" => "list",
            "field" => "key",
            _ => word,
        });
    }
    plain.join(" ")
}

/// A JSON value as a TOML value. A null in a list is a missing number, NaN; any other is left out.
///
/// Written out because another crate in a build may enable serde_json 1.0's feature `arbitrary_precision`, with which
/// numbers are maps for any type except serde_json's own.
fn of_json(value: serde_json::Value) -> Option<Value> {
    use serde_json::Value as Json;
    match value {
        Json::Null => None,
        Json::Bool(on) => Some(Value::Boolean(on)),
        Json::Number(n) => n.as_i64().map(Value::Integer).or(n.as_f64().map(Value::Float)),
        Json::String(text) => Some(Value::String(text)),
        Json::Array(items) => {
            let items = items.into_iter().map(|item| of_json(item).unwrap_or(Value::Float(f64::NAN)));
            Some(Value::Array(items.collect()))
        }
        Json::Object(entries) => {
            let entries = entries.into_iter().filter_map(|(key, value)| Some((key, of_json(value)?)));
            Some(Value::Table(entries.collect()))
        }
    }
}
