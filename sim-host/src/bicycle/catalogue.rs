//! Bicycles by name or from TOML files: one flat set a file, or `FILE#NAME` of a collection.

use super::{KEYS, Parameters, check};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use toml::{Table, Value};

/// The sets that ship, a collection.
const SHIPPED: &str = include_str!("../../../data/bicycles.toml");
/// Where the shipped sets come from, for messages.
const SHIPPED_FILE: &str = "data/bicycles.toml";
/// The form of a set's file that is read.
const SCHEMA: i64 = 1;
/// Keys of a set that are not parameters.
const EXTRA_KEYS: [&str; 4] = ["source", "note", "rider_included", "schema"];

/// A parameter set with its origin.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Bicycle {
    /// Its name, or `FILE` or `FILE#NAME` as given.
    pub name: String,
    /// Where the values come from, as the file says.
    pub source: Option<String>,
    /// A remark of the file's.
    pub note: Option<String>,
    /// What is doubtful about the values, but not refused.
    pub warnings: Vec<String>,
    /// The values.
    pub parameters: Parameters,
}

/// Why there is no such bicycle.
#[derive(Debug, thiserror::Error)]
pub enum BicycleError {
    /// Neither a shipped name nor a file.
    #[error("unknown bicycle `{name}`: no such file, and no such shipped set; shipped are {known}")]
    Unknown {
        /// As given.
        name: String,
        /// The shipped names.
        known: String,
    },
    /// The file can't be read.
    #[error("can't read bicycle file {path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The file is not TOML.
    #[error("{path} is not valid TOML: {reason}")]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The parser's message, with line and column.
        reason: String,
    },
    /// The file has several sets, or not the one asked for.
    #[error("{path} holds several sets; choose one with {path}#NAME, NAME one of {known}")]
    Collection {
        /// The file.
        path: PathBuf,
        /// Its sets.
        known: String,
    },
    /// A set is wrong.
    #[error("{set}: {reason}")]
    Set {
        /// The file, and the set's name in a collection.
        set: String,
        /// Key, value and range.
        reason: String,
    },
}

/// The shipped sets' names, in the file's order.
pub fn shipped_names() -> Vec<String> {
    let sets = parse(SHIPPED, Path::new(SHIPPED_FILE)).unwrap_or_default();
    sets.iter().filter(|(_, v)| v.is_table()).map(|(name, _)| name.clone()).collect()
}

/// A bicycle by `name`: a shipped set, a `FILE` (`-` is standard input), or a `FILE#NAME`; the name of a file may have a
/// `#` itself.
///
/// # Errors
/// Names file, key, value and allowed range.
pub fn load(name: &str) -> Result<Bicycle, BicycleError> {
    if shipped_names().iter().any(|n| n == name) {
        return from_text(name, SHIPPED, Path::new(SHIPPED_FILE), Some(name));
    }
    if name == "-" {
        return from_text("standard input", &standard_input()?, Path::new("standard input"), None);
    }
    let path = Path::new(name);
    if let (false, Some((file, set))) = (path.exists(), name.rsplit_once('#')) {
        return from_text(name, &read(Path::new(file))?, Path::new(file), Some(set));
    }
    if !path.exists() {
        return Err(BicycleError::Unknown { name: name.into(), known: shipped_names().join(", ") });
    }
    from_text(name, &read(path)?, path, None)
}

fn read(path: &Path) -> Result<String, BicycleError> {
    std::fs::read_to_string(path).map_err(|source| BicycleError::Read { path: path.into(), source })
}

/// All of standard input, read once: a sweep's cells share it.
fn standard_input() -> Result<String, BicycleError> {
    static TEXT: Mutex<Option<String>> = Mutex::new(None);
    let mut text = TEXT.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(text) = &*text {
        return Ok(text.clone());
    }
    let all = std::io::read_to_string(std::io::stdin())
        .map_err(|source| BicycleError::Read { path: "standard input".into(), source })?;
    Ok(text.insert(all).clone())
}

/// Checks what is not a parameter.
fn check_remarks(values: &Table) -> Result<(), String> {
    for (key, kind) in [("source", "string"), ("note", "string"), ("rider_included", "boolean")] {
        if let Some(value) = values.get(key).filter(|value| value.type_str() != kind) {
            return Err(format!("`{key}` must be a {kind}, not the {} {value}", value.type_str()));
        }
    }
    match values.get("schema") {
        None | Some(Value::Integer(SCHEMA)) => Ok(()),
        Some(other) => Err(format!("`schema` = {other} is not known; this program reads {SCHEMA}")),
    }
}

fn parse(text: &str, path: &Path) -> Result<Table, BicycleError> {
    toml::from_str(text)
        .map_err(|e| BicycleError::Syntax { path: path.into(), reason: e.to_string().trim().into() })
}

/// A bicycle from a file's text; `set` names one of a collection.
///
/// # Errors
/// As [`load`].
pub fn from_text(name: &str, text: &str, path: &Path, set: Option<&str>) -> Result<Bicycle, BicycleError> {
    let table = parse(text, path)?;
    let sets: Vec<&str> = table.iter().filter(|(_, v)| v.is_table()).map(|(k, _)| k.as_str()).collect();
    let (label, values) = match set {
        Some(set) => match table.get(set) {
            Some(Value::Table(values)) => (format!("{}#{set}", path.display()), values),
            _ if sets.is_empty() => {
                let reason = format!("holds one set without a name, not `{set}`; leave out #{set}");
                return Err(BicycleError::Set { set: path.display().to_string(), reason });
            }
            _ => return Err(BicycleError::Collection { path: path.into(), known: sets.join(", ") }),
        },
        None if !sets.is_empty() => {
            return Err(BicycleError::Collection { path: path.into(), known: sets.join(", ") });
        }
        None => (path.display().to_string(), &table),
    };
    let wrong = |reason: String| BicycleError::Set { set: label.clone(), reason };
    if let Some(key) =
        values.keys().find(|k| !KEYS.contains(&k.as_str()) && !EXTRA_KEYS.contains(&k.as_str()))
    {
        return Err(wrong(format!("unknown key `{key}`; the parameters are {}", KEYS.join(", "))));
    }
    check_remarks(values).map_err(wrong)?;
    let mut numbers = [0.0; KEYS.len()];
    for (key, number) in KEYS.iter().zip(&mut numbers) {
        *number = match values.get(*key) {
            Some(Value::Float(x)) => *x,
            Some(Value::Integer(i)) => *i as f64,
            Some(other) => {
                return Err(wrong(format!("`{key}` must be a number, not the {} {other}", other.type_str())));
            }
            None => return Err(wrong(format!("`{key}` is missing; {}", check::describe(key)))),
        };
    }
    let parameters = Parameters::from_values(&numbers);
    let warnings = check::check(&parameters).map_err(wrong)?;
    let text = |key: &str| values.get(key).and_then(Value::as_str).map(str::to_owned);
    Ok(Bicycle { name: name.into(), source: text("source"), note: text("note"), warnings, parameters })
}
