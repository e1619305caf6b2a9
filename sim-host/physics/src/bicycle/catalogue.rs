//! Loads bicycles by name or from files: one flat set per file, or `FILE#NAME` of a collection.

pub use super::error::BicycleError;
use super::error::{SCHEMA, SetError};
use super::extras::{is_extra, left_out, unknown_body};
use super::rider_body::{packaged, rider_file, split, with_rider};
pub use super::set::Bicycle;
use super::uncertain::{Measured, Uncertain};
use super::{KEYS, check, formats};
use std::path::Path;
use std::sync::{LazyLock, Mutex, PoisonError};
use toml::{Table, Value};

/// The shipped sets, a collection.
const SHIPPED: &str = include_str!("../../../../data/bicycles.toml");
/// File of the shipped sets, for messages.
const SHIPPED_FILE: &str = "data/bicycles.toml";
/// The shipped sets, parsed once: it takes milliseconds, and each cell of a sweep has a bicycle.
static SETS: LazyLock<Table> = LazyLock::new(|| parse(SHIPPED, Path::new(SHIPPED_FILE)).unwrap_or_default());
/// Keys of a set that are not parameters.
const EXTRA_KEYS: [&str; 4] = ["source", "note", "rider_included", "schema"];

/// Names of the shipped sets, in the file's order.
pub fn shipped_names() -> Vec<String> {
    SETS.iter().filter(|(_, v)| v.is_table()).map(|(name, _)| name.clone()).collect()
}

/// Loads a bicycle by `name`: a shipped set, a `FILE` (`-` is standard input), a `FILE#NAME` (the file's name
/// may contain a `#`), a folder of BicycleParameters' `data/bicycles`, or one of these with a rider's body,
/// `BICYCLE+RIDER` ([`super::combine`]).
///
/// # Errors
/// States file, key, value and allowed range.
pub fn load(name: &str) -> Result<Bicycle, BicycleError> {
    if let Some((bicycle, rider)) = split(name) {
        let (base, path) = (load(bicycle)?, rider_file(bicycle, rider));
        let table = parse(&read(&path)?, &path)?;
        return with_rider(name, bicycle, base, &table, &path);
    }
    if shipped_names().iter().any(|n| n == name) {
        return from_table(name, &SETS, Path::new(SHIPPED_FILE), Some(name));
    }
    if name == "-" {
        return from_text("standard input", &standard_input()?, Path::new("standard input"), None);
    }
    if let (false, Some((file, set))) = (Path::new(name).exists(), name.rsplit_once('#')) {
        return from_file(name, Path::new(file), Some(set));
    }
    let path = &*packaged(Path::new(name));
    if !path.exists() {
        return Err(BicycleError::Unknown { name: name.into(), known: shipped_names().join(", ") });
    }
    from_file(name, path, None)
}

fn from_file(name: &str, path: &Path, set: Option<&str>) -> Result<Bicycle, BicycleError> {
    let text = read(path)?;
    let mut bicycle = from_text(name, &text, path, set)?;
    // A file truncated within its last number still parses.
    if text.ends_with(|c: char| c.is_ascii_digit() || c == '.') {
        bicycle.warnings.push("the file's last line has no end; its last value may be truncated".into());
    }
    Ok(bicycle)
}

fn read(path: &Path) -> Result<String, BicycleError> {
    crate::input_file::text(path).map_err(|source| BicycleError::Read { path: path.into(), source })
}

/// All of standard input, read once and shared by a sweep's cells.
fn standard_input() -> Result<String, BicycleError> {
    static TEXT: Mutex<Option<String>> = Mutex::new(None);
    let mut text = TEXT.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(text) = &*text {
        return Ok(text.clone());
    }
    let all = crate::input_file::standard_input()
        .map_err(|source| BicycleError::Read { path: "standard input".into(), source })?;
    Ok(text.insert(all).clone())
}

/// Checks the keys that are not parameters.
fn check_remarks(values: &Table) -> Result<(), SetError> {
    for (key, kind) in [("source", "string"), ("note", "string"), ("rider_included", "boolean")] {
        if let Some(value) = values.get(key).filter(|value| value.type_str() != kind) {
            return Err(SetError::Type { key, kind, found: value.type_str(), value: value.to_string() });
        }
    }
    match values.get("schema") {
        None | Some(Value::Integer(SCHEMA)) => Ok(()),
        Some(other) => Err(SetError::Schema(other.to_string())),
    }
}

fn parse(text: &str, path: &Path) -> Result<Table, BicycleError> {
    formats::table(text, path).map_err(|reason| BicycleError::Syntax { path: path.into(), reason })
}

/// A bicycle from a file's text; `set` is the name of a set in a collection.
///
/// # Errors
/// As [`load`].
pub fn from_text(name: &str, text: &str, path: &Path, set: Option<&str>) -> Result<Bicycle, BicycleError> {
    from_table(name, &parse(text, path)?, path, set)
}

fn from_table(name: &str, table: &Table, path: &Path, set: Option<&str>) -> Result<Bicycle, BicycleError> {
    let sets: Vec<&str> = table.iter().filter(|(_, v)| v.is_table()).map(|(k, _)| k.as_str()).collect();
    let (label, values) = match set {
        Some(set) => match table.get(set) {
            Some(Value::Table(values)) => (format!("{}#{set}", path.display()), values),
            _ if sets.is_empty() => {
                let reason = SetError::OneSet(set.into());
                return Err(BicycleError::Set { set: path.display().to_string(), reason });
            }
            _ => return Err(BicycleError::Collection { path: path.into(), known: sets.join(", ") }),
        },
        None if !sets.is_empty() => {
            return Err(BicycleError::Collection { path: path.into(), known: sets.join(", ") });
        }
        None => (path.display().to_string(), table),
    };
    let wrong = |reason: SetError| BicycleError::Set { set: label.clone(), reason };
    if let Some(key) = values
        .keys()
        .find(|k| !KEYS.contains(&k.as_str()) && !EXTRA_KEYS.contains(&k.as_str()) && !is_extra(k))
    {
        return Err(wrong(SetError::Key { key: key.clone(), body: unknown_body(key) }));
    }
    check_remarks(values).map_err(wrong)?;
    let mut bicycle = Vec::new();
    for key in KEYS {
        let value = values.get(key).ok_or_else(|| wrong(missing(values, key)))?;
        bicycle.push(Uncertain::of_value(value).map_err(|error| wrong(SetError::Number { key, error }))?);
    }
    let measured = Measured { bicycle, rider: None };
    let parameters = measured.parameters();
    let mut warnings = check::check(&parameters).map_err(|error| wrong(error.into()))?;
    let (extra_warnings, left_out) = left_out(values).map_err(wrong)?;
    warnings.extend(extra_warnings);
    let text = |key: &str| values.get(key).and_then(Value::as_str).map(str::to_owned);
    let note: Vec<String> = text("note").into_iter().chain(left_out).collect();
    Ok(Bicycle {
        name: name.into(),
        source: text("source"),
        note: (!note.is_empty()).then(|| note.join("; ")),
        rider_included: values.get("rider_included").and_then(Value::as_bool),
        warnings,
        measured: Some(measured).filter(Measured::is_uncertain),
        parameters,
    })
}

/// The error of a missing key.
fn missing(values: &Table, key: &'static str) -> SetError {
    let of_rider = values.keys().all(|k| super::combine::RIDER_KEYS.contains(&k.as_str()));
    SetError::Missing { key, rider_alone: of_rider && !values.is_empty() }
}
