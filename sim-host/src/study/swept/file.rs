//! A sweep study as defined in a TOML file.

use super::error::{PartError, StudyError};
use super::options::StudyOptions;
use crate::sweep::{Axis, AxisError};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// A question and the sweeps that answer it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Study {
    /// Its name, equal to that of its files.
    #[serde(skip)]
    pub name: String,
    /// Its file as given, or the name of a built-in study, for messages.
    #[serde(skip)]
    pub source: String,
    /// Title of the page.
    pub title: String,
    /// The question, and the method.
    pub question: String,
    /// Remarks below the answers.
    #[serde(default)]
    pub remarks: String,
    /// The sweeps.
    #[serde(rename = "sweep")]
    pub parts: Vec<Part>,
}

/// One sweep of a study and the evaluation of its result.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Its name, equal to that of its folder and figures.
    pub name: String,
    /// Title above its answer.
    pub title: String,
    /// Text before its answer.
    #[serde(default)]
    pub text: String,
    /// Options of `sweep` for all cells, and those of the search.
    pub options: StudyOptions,
    /// The axes, in the form of `--over`.
    pub over: Vec<String>,
    /// The reference cell: one value by key. Axes without an entry define groups, each with its own reference.
    pub reference: BTreeMap<String, String>,
    /// Unit of the numbers along the axis below, if they have none.
    #[serde(default)]
    pub unit: String,
    /// The axis along which the area is compared; along an axis of names, every value is compared.
    pub along: String,
}

/// Parses a study from a TOML text. `source` is its file or the name of a built-in study.
///
/// # Errors
/// Names source, sweep and key.
pub fn parse(source: &str, text: &str) -> Result<Study, StudyError> {
    let syntax =
        |e: toml::de::Error| StudyError::Syntax { name: source.into(), reason: e.to_string().trim().into() };
    let mut study: Study = toml::from_str(text).map_err(syntax)?;
    study.name =
        Path::new(source).file_stem().map_or(source.into(), |stem| stem.to_string_lossy().into_owned());
    study.source = source.into();
    for part in &study.parts {
        let wrong = |error| StudyError::Part {
            name: source.into(),
            sweep: part.name.clone(),
            error: Box::new(error),
        };
        part.check().map_err(wrong)?;
    }
    Ok(study)
}

impl Part {
    /// Its axes.
    ///
    /// # Errors
    /// An invalid axis.
    pub fn axes(&self) -> Result<Vec<Axis>, AxisError> {
        self.over.iter().map(|text| Axis::parse(text)).collect()
    }

    fn check(&self) -> Result<(), PartError> {
        self.options.settings()?;
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '-';
        if self.name.is_empty() || !self.name.chars().all(plain) {
            return Err(PartError::Name);
        }
        let axes = self.axes()?;
        for (key, value) in &self.reference {
            let axis = axes.iter().find(|axis| axis.key == *key);
            if !axis.is_some_and(|axis| axis.values.contains(value)) {
                return Err(PartError::Reference { key: key.clone(), value: value.clone() });
            }
        }
        if !self.reference.contains_key(&self.along) {
            return Err(PartError::Along(self.along.clone()));
        }
        if self.reference.len() > 3 {
            return Err(PartError::Large);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_in_a_file_are_named() {
        let right = "title='t'\nquestion='q'\n[[sweep]]\nname='a'\ntitle='t'\noptions=''\nover=['law=h,f']\n\
                     reference={law='h'}\nalong='law'\n";
        assert_eq!(parse("f/s.toml", right).unwrap().name, "s");
        for (from, to, named) in [
            ("law='h'", "law='g'", "law=g"),
            ("along='law'", "along='imu'", "`imu`"),
            ("name='a'", "name='../a'", "name"),
            ("law=h,f", "law=h,h", "twice"),
            ("options=''", "option=''", "option"),
            ("options=''", "options={lwa='h'}", "`lwa`"),
            ("options=''", "options={law=['h','f']}", "`law` can be given once"),
            ("options=''", "options=3", "a table of options"),
            ("law='h'}", "law=['h']}", "law=['h']"),
        ] {
            let error = parse("f/s.toml", &right.replace(from, to)).unwrap_err().to_string();
            assert!(error.starts_with("study f/s.toml: ") && error.contains(named), "{error}");
        }
    }
}
