//! Parses bicycle files by their extension: `.txt` and `.ini` as written by BicycleParameters, sets in YAML
//! or JSON, otherwise TOML.

use super::error::{FormatError, NumberError};
use super::uncertain::Uncertain;
use crate::json;
use std::collections::BTreeMap;
use std::path::Path;
use toml::{Table, Value};

/// A file's text as a TOML table.
///
/// # Errors
/// States the fault and its line.
pub(super) fn table(text: &str, path: &Path) -> Result<Table, FormatError> {
    let ending = path.extension().map_or(String::new(), |e| e.to_string_lossy().to_lowercase());
    match ending.as_str() {
        "txt" | "ini" => lines(text),
        "yml" | "yaml" => set(yaml(text)?),
        "json" => {
            let all: BTreeMap<String, serde_json::Value> =
                serde_json::from_str(text).map_err(|e| invalid("JSON", &e))?;
            set(all.into_iter().map(|(key, value)| (key, json::as_toml(value))).collect())
        }
        _ => toml::from_str(text).map_err(|e| invalid("TOML", &e)),
    }
}

#[cfg(feature = "yaml")]
fn yaml(text: &str) -> Result<BTreeMap<String, Option<Value>>, FormatError> {
    serde_saphyr::from_str(text).map_err(|e| invalid("YAML", &e))
}

#[cfg(not(feature = "yaml"))]
fn yaml(_: &str) -> Result<BTreeMap<String, Option<Value>>, FormatError> {
    Err(FormatError::NoYaml)
}

fn invalid(format: &'static str, error: &dyn std::fmt::Display) -> FormatError {
    FormatError::Invalid { format, reason: error.to_string().trim().into() }
}

/// Lines `KEY = VALUE`, values as `1.12` or `1.12+/-0.02`; comma-separated values are averaged; `#` begins a
/// comment.
fn lines(text: &str) -> Result<Table, FormatError> {
    let mut table = Table::new();
    for (n, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default().trim();
        if line.is_empty() {
            continue;
        }
        let (text, line) = (line.to_owned(), n + 1);
        let Some((key, values)) = text.split_once('=') else { return Err(FormatError::Line { line, text }) };
        let value = match mean(values) {
            Ok(value) => value,
            Err(error) => return Err(FormatError::Number { line, text, error }),
        };
        if table.insert(key.trim().into(), value).is_some() {
            return Err(FormatError::Twice { line, text });
        }
    }
    Ok(table)
}

fn mean(list: &str) -> Result<Value, NumberError> {
    let one = |text: &str| match text.trim().parse() {
        Ok(value) => Ok(Uncertain::exact(value)),
        Err(_) => Uncertain::parse(text.trim()),
    };
    let all: Vec<Uncertain> = list.split(',').map(one).collect::<Result<_, _>>()?;
    let n = all.len() as f64;
    let value = all.iter().map(|u| u.value).sum::<f64>() / n;
    let sd = all.iter().map(|u| u.sd * u.sd).sum::<f64>().sqrt() / n;
    Ok(if sd > 0.0 { Value::String(format!("{value:?}+/-{sd:?}")) } else { Value::Float(value) })
}

/// Names for the model's 26 parameters as a set: in BicycleParameters' test sets, and in its output.
const PARAMETERIZATIONS: [&str; 2] = ["benchmark", "Meijaard2007"];

/// A mapping of keys to numbers, either flat or under `values` next to one of [`PARAMETERIZATIONS`]. Null
/// values are ignored.
fn set(all: BTreeMap<String, Option<Value>>) -> Result<Table, FormatError> {
    let mut table: Table = all.into_iter().filter_map(|(key, value)| Some((key, value?))).collect();
    let Some(values) = table.remove("values") else { return Ok(table) };
    let Value::Table(mut values) = values else { return Err(FormatError::NoMapping) };
    let named = table.get("parameterization").and_then(Value::as_str);
    if let Some(other) = named.filter(|name| !PARAMETERIZATIONS.contains(name)) {
        let known = PARAMETERIZATIONS.map(|name| format!("`{name}`")).join(" and ");
        return Err(FormatError::Parameterization { found: other.into(), known });
    }
    let rider = table.remove("rider").map(|rider| ("rider_included".to_owned(), rider));
    let note = table.remove("description").map(|note| ("note".to_owned(), note));
    values.extend(rider.into_iter().chain(note.filter(|(_, note)| note.as_str() != Some(""))));
    Ok(values)
}
