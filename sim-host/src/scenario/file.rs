//! Scenario files: TOML, or JSON, which can also be a result that contains its scenario.

use super::{Scenario, ScenarioError};
use crate::input_file;
use crate::json;
use std::path::Path;
use toml::Value;

/// A text that is no scenario: the parser's message, with line or key and what was expected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct SyntaxError {
    message: String,
    key: Option<String>,
}

impl SyntaxError {
    /// A parser's message, without the names of Rust's types.
    fn new(error: &impl ToString) -> Self {
        Self { message: in_plain_words(error.to_string().trim()), key: None }
    }

    /// The message about a key.
    fn at<E: ToString>(error: &serde_path_to_error::Error<E>) -> Self {
        let key = Some(error.path().to_string()).filter(|key| key != ".");
        Self { key, ..Self::new(error.inner()) }
    }

    /// The message about a key, without the line.
    fn without_line(error: &serde_path_to_error::Error<toml::de::Error>) -> Self {
        let mut message = error.inner().clone();
        message.set_input(None);
        Self { key: Self::at(error).key, ..Self::new(&message) }
    }

    /// The wrong or unknown key, with dots, if one is to blame.
    pub fn key(&self) -> Option<&str> {
        self.key.as_deref()
    }
}

impl Scenario {
    /// Reads a scenario from a file, or from standard input (`-`): JSON if it begins with a brace or its name ends in `.json`, otherwise TOML. Of a
    /// result of `ride`, `basin` or `basin plane`, the scenario in it.
    ///
    /// # Errors
    /// States file, line or key, and what was expected; a file without a key is no scenario.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let text = match path.to_str() {
            Some("-") => input_file::standard_input(),
            _ => input_file::text(path),
        };
        let text = text.map_err(|source| ScenarioError::Read { path: path.into(), source })?;
        let text = text.trim_start_matches('\u{feff}');
        let json = text.trim_start().starts_with('{')
            || path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
        let read = match (states_nothing(text, json), json) {
            (true, _) => Err(SyntaxError::new(&NOTHING)),
            (false, true) => Self::from_json(text),
            (false, false) => Self::from_toml(text),
        };
        read.map_err(|reason| ScenarioError::Syntax { path: path.into(), reason })
    }

    /// Parses a scenario in TOML.
    ///
    /// # Errors
    /// States line, key and what was expected.
    pub fn from_toml(text: &str) -> Result<Self, SyntaxError> {
        let file = toml::Deserializer::parse(text).map_err(|e| SyntaxError::new(&e))?;
        serde_path_to_error::deserialize(file).map_err(|e| SyntaxError::at(&e))
    }

    /// Parses a scenario in JSON, or the scenario of a result.
    ///
    /// # Errors
    /// States line or key, and what was expected.
    pub fn from_json(text: &str) -> Result<Self, SyntaxError> {
        let value: serde_json::Value = serde_json::from_str(text).map_err(|e| SyntaxError::new(&e))?;
        let Some(Value::Table(mut table)) = json::as_toml(value) else {
            return Err(SyntaxError::new(&"expected an object"));
        };
        let wrong = |reason: &str| Err(SyntaxError::new(&reason));
        // Every document with a scenario in it has its configuration beside it.
        let of_result = table.contains_key("tool") || table.contains_key("config");
        let own = match table.remove("scenario") {
            Some(own) if of_result => own,
            Some(_) => return wrong("`scenario` is a key of results only"),
            None if table.contains_key("cells") => return wrong("the scenarios are in `cells[i].scenario`"),
            None if table.contains_key("cases") => return wrong("the scenarios are in `cases[i].scenario`"),
            None if of_result => return wrong("this result has no `scenario`"),
            None => Value::Table(table),
        };
        // Through the text, so that every type of a scenario is read by one parser: a second is 4 % of the code of this crate.
        let text = toml::to_string(&own).map_err(|e| SyntaxError::new(&e))?;
        let file = toml::Deserializer::parse(&text).map_err(|e| SyntaxError::new(&e))?;
        serde_path_to_error::deserialize(file).map_err(|e| SyntaxError::without_line(&e))
    }

    /// The scenario as a TOML file.
    ///
    /// # Errors
    /// A number that TOML does not have: a seed above 2^63 - 1, which only code can set.
    pub fn to_toml(&self) -> Result<String, SyntaxError> {
        toml::to_string(self).map_err(|e| SyntaxError::new(&e))
    }
}

/// The message of a file without a key.
const NOTHING: &str =
    "there is no key in it; expected those of a scenario, for example law = \"h\" (docs/scenario.md)";

/// Whether a file's text is without a key, as that of an empty file.
fn states_nothing(text: &str, json: bool) -> bool {
    match json {
        true => serde_json::from_str(text).is_ok_and(|table: serde_json::Map<_, _>| table.is_empty()),
        false => text.parse().is_ok_and(|table: toml::Table| table.is_empty()),
    }
}

/// Choices beside a scenario, from JSON.
///
/// # Errors
/// States the key, and what was expected.
pub fn choices<T: serde::de::DeserializeOwned>(json: &str) -> Result<T, SyntaxError> {
    let value: serde_json::Value = serde_json::from_str(json).map_err(|e| SyntaxError::new(&e))?;
    serde_path_to_error::deserialize(value).map_err(|e| SyntaxError::at(&e))
}

/// A parser's message without the names of Rust's types.
fn in_plain_words(message: &str) -> String {
    let tables = ["Scenario", "RiderChoice", "PlantChoice", "SensorChange", "ActuatorChoice", "FallChoice"];
    let tables = tables.into_iter().chain(["SearchChoice", "PlaneSearch", "Start", "ImuMount", "LaidFlat"]);
    let plain =
        tables.fold(message.to_owned(), |text, name| text.replace(&format!("struct {name}"), "a table"));
    let types =
        [("usize", WHOLE), ("u64", WHOLE), ("u32", WHOLE), ("f64", "a number"), ("a sequence", "a list")];
    types.into_iter().fold(plain, |text, (name, words)| {
        text.replace(&format!("expected {name}"), &format!("expected {words}"))
    })
}

/// The integer types of a scenario.
const WHOLE: &str = "a whole number from 0";
