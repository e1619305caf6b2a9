//! Loads bicycles by name or from files: one flat set per file, or `FILE#NAME` of a collection.

use super::combine::{self, number, packaged};
use super::extras::{is_extra, left_out, unknown_body};
use super::uncertain::Measured;
use super::{KEYS, Parameters, check, formats};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use toml::{Table, Value};

/// The shipped sets, a collection.
const SHIPPED: &str = include_str!("../../../../data/bicycles.toml");
/// File of the shipped sets, for messages.
const SHIPPED_FILE: &str = "data/bicycles.toml";
/// Supported schema version of a set's file.
const SCHEMA: i64 = 1;
/// Keys of a set that are not parameters.
const EXTRA_KEYS: [&str; 4] = ["source", "note", "rider_included", "schema"];

/// A parameter set and its origin.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bicycle {
    /// Name, or `FILE` or `FILE#NAME` as given.
    pub name: String,
    /// Origin of the values, from the file.
    #[serde(default)]
    pub source: Option<String>,
    /// Remark from the file.
    #[serde(default)]
    pub note: Option<String>,
    /// Whether the rear frame includes a rider's body; `None` if the file does not state it.
    #[serde(default)]
    pub rider_included: Option<bool>,
    /// Doubtful but accepted values.
    #[serde(default)]
    pub warnings: Vec<String>,
    /// The values with their uncertainties, if the file has any.
    #[serde(default)]
    pub measured: Option<Measured>,
    /// The values.
    pub parameters: Parameters,
}

impl Bicycle {
    /// Checks a bicycle that does not come from a file, and adds the warnings that a file's would have.
    ///
    /// # Errors
    /// States the key, the value and its range.
    pub fn checked(mut self) -> Result<Self, String> {
        if let Some(measured) = &self.measured
            && !(measured.is_complete() && measured.parameters() == self.parameters)
        {
            return Err("`measured` and `parameters` have different values".into());
        }
        for warning in check::check(&self.parameters)? {
            if !self.warnings.contains(&warning) {
                self.warnings.push(warning);
            }
        }
        Ok(self)
    }
}

/// Reason why a bicycle cannot be loaded.
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
        /// The operating system's error.
        source: std::io::Error,
    },
    /// The file's syntax is wrong.
    #[error("{path} {reason}")]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The parser's message, with line and column.
        reason: String,
    },
    /// The file has several sets, and no or an unknown name was given.
    #[error("{path} holds several sets; choose one with {path}#NAME, NAME one of {known}")]
    Collection {
        /// The file.
        path: PathBuf,
        /// Names of its sets.
        known: String,
    },
    /// A set has a wrong value or key.
    #[error("{set}: {reason}")]
    Set {
        /// The file, and the set's name in a collection.
        set: String,
        /// Key, value and range.
        reason: String,
    },
}

/// Names of the shipped sets, in the file's order.
pub fn shipped_names() -> Vec<String> {
    let sets = parse(SHIPPED, Path::new(SHIPPED_FILE)).unwrap_or_default();
    sets.iter().filter(|(_, v)| v.is_table()).map(|(name, _)| name.clone()).collect()
}

/// Loads a bicycle by `name`: a shipped set, a `FILE` (`-` is standard input), a `FILE#NAME` (the file's name
/// may contain a `#`), a folder of BicycleParameters' `data/bicycles`, or one of these with a rider's body,
/// `BICYCLE+RIDER` ([`combine`]).
///
/// # Errors
/// States file, key, value and allowed range.
pub fn load(name: &str) -> Result<Bicycle, BicycleError> {
    if let Some((bicycle, rider)) = combine::split(name) {
        return combine::load_with(name, bicycle, rider);
    }
    if shipped_names().iter().any(|n| n == name) {
        return from_text(name, SHIPPED, Path::new(SHIPPED_FILE), Some(name));
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
    std::fs::read_to_string(path).map_err(|source| BicycleError::Read { path: path.into(), source })
}

/// All of standard input, read once and shared by a sweep's cells.
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

/// Checks the keys that are not parameters.
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
    formats::table(text, path).map_err(|reason| BicycleError::Syntax { path: path.into(), reason })
}

/// Reads a file as a table.
pub(super) fn read_table(path: &Path) -> Result<Table, BicycleError> {
    parse(&read(path)?, path)
}

/// A bicycle from a file's text; `set` is the name of a set in a collection.
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
    if let Some(key) = values
        .keys()
        .find(|k| !KEYS.contains(&k.as_str()) && !EXTRA_KEYS.contains(&k.as_str()) && !is_extra(k))
    {
        let error = unknown_body(key).unwrap_or(format!("unknown key `{key}`"));
        return Err(wrong(format!("{error}; the parameters are {}", KEYS.join(", "))));
    }
    check_remarks(values).map_err(wrong)?;
    let mut bicycle = Vec::new();
    for key in KEYS {
        let value = values.get(key).ok_or_else(|| wrong(missing(values, key)))?;
        bicycle.push(number(value).map_err(|error| wrong(format!("`{key}` {error}")))?);
    }
    let measured = Measured { bicycle, rider: None };
    let parameters = measured.parameters();
    let mut warnings = check::check(&parameters).map_err(wrong)?;
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

/// Error text for a missing key.
fn missing(values: &Table, key: &str) -> String {
    let riders = values.keys().all(|k| combine::RIDER_KEYS.contains(&k.as_str()));
    let hint = if riders && !values.is_empty() {
        "; the file holds a rider's body alone; give it after a bicycle: BICYCLE+FILE"
    } else {
        ""
    };
    format!("`{key}` is missing; {}{hint}", check::describe(key))
}
