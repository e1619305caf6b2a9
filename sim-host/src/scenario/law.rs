//! The law of a scenario: a name, a table file, or a table in place.

use super::content::Content;
use super::text::decimal;
use control::law::{LAWS, LawError};
use control::param::{ParamError, ParamSpec};
use control::{Capsize, GainSchedule, Law};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Allowed laws, for messages.
fn allowed() -> String {
    let laws = LAWS.iter().filter(|spec| !spec.is_table());
    let names =
        laws.map(|spec| if spec.parameter.is_some() { format!("{}:K", spec.name) } else { spec.name.into() });
    format!(
        "{} (K > 0), or a TOML file with speed_m_s and gain_nm_s_rad",
        names.collect::<Vec<String>>().join(", ")
    )
}

/// A law that cannot be loaded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LawChoiceError {
    /// Neither a built-in law nor a file.
    #[error("unknown law `{0}`: no such file, and not one of {known}", known = allowed())]
    Unknown(String),
    /// The law's number is missing or not a number.
    #[error(
        "law `{text}`: expected {name}:K, K a number from {min} to {max}",
        name = name_of(.text), min = .number.min, max = .number.max
    )]
    Number {
        /// As given.
        text: String,
        /// The number.
        number: ParamSpec,
    },
    /// A number for a law without one.
    #[error("law `{0}`: {name} takes no number", name = name_of(.0))]
    NoNumber(String),
    /// The law's number is outside its range.
    #[error("law `{text}`: {error}")]
    Range {
        /// As given.
        text: String,
        /// The error.
        error: ParamError,
    },
    /// The file can't be read.
    #[error("can't read law file {path}: {reason}")]
    Read {
        /// The file.
        path: String,
        /// The operating system's error.
        reason: String,
    },
    /// Not a table of gains.
    #[error("{place}: {reason}")]
    Syntax {
        /// The law, and its file.
        place: String,
        /// The parser's message.
        reason: String,
    },
    /// Different numbers of speeds and gains.
    #[error("{place}: speed_m_s has {speeds} values, gain_nm_s_rad has {gains}; they must match")]
    Lengths {
        /// The law, and its file or name.
        place: String,
        /// Number of speeds.
        speeds: usize,
        /// Number of gains.
        gains: usize,
    },
    /// A speed or a gain outside its range.
    #[error("{place}: {error}{}", if error.leaf.name.contains("speed") { " (speeds must rise)" } else { "" })]
    Point {
        /// The law, and its file or name.
        place: String,
        /// The error.
        error: ParamError,
    },
    /// A table with the name of a built-in law.
    #[error("law: `{0}` is the name of a built-in law; choose another for the table")]
    BuiltIn(String),
    /// A file in the place of its table.
    #[error("law `{0}` is a file; insert its table here")]
    File(String),
    /// A text that is no capsize term.
    #[error("`{0}` is not K:V, N s/rad and m/s, for example 0.7:6.5")]
    CapsizeForm(String),
    /// A number of the capsize term is outside its range.
    #[error(transparent)]
    Capsize(ParamError),
}

/// The law's name in `NAME:K`.
fn name_of(text: &str) -> &str {
    text.split_once(':').map_or(text, |(name, _)| name)
}

/// A gain table, as in a law file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LawTable {
    /// Name in results; absent for the file's own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Speeds \[m/s\], rising.
    pub speed_m_s: Vec<f64>,
    /// Gains \[N m s/rad\], positive steering into the fall.
    pub gain_nm_s_rad: Vec<f64>,
    /// Source of the values.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
}

/// A law as a value of a scenario: by name, or its table in place.
pub fn content(name: &str, law: &Law) -> Content<LawTable> {
    let Law::Table(table) = law else { return Content::Named(law.to_string()) };
    let points = table.points();
    Content::Given(Box::new(LawTable {
        name: Some(name.into()),
        speed_m_s: points.iter().map(|point| decimal(point.0)).collect(),
        gain_nm_s_rad: points.iter().map(|point| decimal(point.1)).collect(),
        source: None,
    }))
}

/// The law of a scenario, and its name in results.
///
/// # Errors
/// States the law, its number and range, or file and value.
pub fn resolve(choice: &Content<LawTable>) -> Result<(String, Law), LawChoiceError> {
    match choice {
        Content::Named(name) => Ok((name.clone(), parse(name)?)),
        Content::Given(table) => {
            let name = table.name.clone().unwrap_or_else(|| "table".into());
            if name.parse::<Law>().is_ok() {
                return Err(LawChoiceError::BuiltIn(name));
            }
            let law = of_table((**table).clone(), &format!("law {name}"))?;
            Ok((name, law))
        }
    }
}

/// The law with this name or from this file.
///
/// # Errors
/// States the law, its number and range, or file and value.
pub fn parse(text: &str) -> Result<Law, LawChoiceError> {
    text.parse::<Law>().or_else(|error| match error {
        LawError::Unknown => table(text),
        LawError::NotANumber(number) => Err(LawChoiceError::Number { text: text.into(), number }),
        LawError::NoParameter => Err(LawChoiceError::NoNumber(text.into())),
        LawError::OutOfRange(error) => Err(LawChoiceError::Range { text: text.into(), error }),
    })
}

/// The capsize term of `K:V`.
///
/// # Errors
/// The expected form, or a number outside its range.
pub fn capsize(text: &str) -> Result<Capsize, LawChoiceError> {
    let numbers = text.split_once(':').and_then(|(k, v)| Some((k.parse().ok()?, v.parse().ok()?)));
    let (k_c, v_max_m_s) = numbers.ok_or_else(|| LawChoiceError::CapsizeForm(text.into()))?;
    let capsize = Capsize { k_c, v_max_m_s };
    capsize.validate().map_err(LawChoiceError::Capsize)?;
    Ok(capsize)
}

/// The law in a parameter file: a name, or a table.
pub(super) fn of_value(value: toml::Value) -> Result<Law, LawChoiceError> {
    match value {
        toml::Value::String(name) => match parse(&name) {
            Ok(Law::Table(_)) => Err(LawChoiceError::File(name)),
            law => law,
        },
        table => {
            let wrong = |e: toml::de::Error| syntax("law", e.message());
            of_table(table.try_into().map_err(wrong)?, "law")
        }
    }
}

fn table(path: &str) -> Result<Law, LawChoiceError> {
    if !std::path::Path::new(path).exists() {
        return Err(LawChoiceError::Unknown(path.into()));
    }
    let text = crate::input_file::text(std::path::Path::new(path))
        .map_err(|e| LawChoiceError::Read { path: path.into(), reason: e.to_string() })?;
    let place = format!("law file {path}");
    of_table(toml::from_str(&text).map_err(|e| syntax(&place, e.to_string().trim()))?, &place)
}

fn syntax(place: &str, reason: &str) -> LawChoiceError {
    LawChoiceError::Syntax { place: place.into(), reason: reason.into() }
}

fn of_table(file: LawTable, place: &str) -> Result<Law, LawChoiceError> {
    let (speeds, gains) = (file.speed_m_s.len(), file.gain_nm_s_rad.len());
    if speeds != gains {
        return Err(LawChoiceError::Lengths { place: place.into(), speeds, gains });
    }
    let points = file.speed_m_s.into_iter().zip(file.gain_nm_s_rad);
    let points: Vec<(f32, f32)> = points.map(|(speed, gain)| (speed as f32, gain as f32)).collect();
    let wrong = |error| LawChoiceError::Point { place: place.into(), error };
    GainSchedule::new(&points).map(Law::Table).map_err(wrong)
}
