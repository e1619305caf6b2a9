//! A sweep study as defined in a TOML file.

use crate::sweep::Axis;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A question and the sweeps that answer it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Study {
    /// Its name, equal to that of its files.
    #[serde(skip)]
    pub name: String,
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
    pub options: String,
    /// The axes, in the form of `--over`.
    pub over: Vec<String>,
    /// The reference cell: values by key. Axes without an entry define groups, each with its own reference.
    pub reference: BTreeMap<String, String>,
    /// Unit of the numbers along the axis below, if they have none.
    #[serde(default)]
    pub unit: String,
    /// The axis along which the area is compared; along an axis of names, every value is compared.
    pub along: String,
}

/// Why a study cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct StudyError(pub String);

/// Parses the study `name` from a TOML text.
///
/// # Errors
/// Names study, sweep and key.
pub fn parse(name: &str, text: &str) -> Result<Study, StudyError> {
    let wrong = |what: &str| StudyError(format!("study {name}: {}", what.trim()));
    let mut study: Study = toml::from_str(text).map_err(|e| wrong(&e.to_string()))?;
    study.name = name.into();
    for part in &study.parts {
        part.check().map_err(|e| wrong(&format!("sweep {}: {e}", part.name)))?;
    }
    Ok(study)
}

impl Part {
    /// Its axes.
    ///
    /// # Errors
    /// An invalid axis.
    pub fn axes(&self) -> Result<Vec<Axis>, String> {
        self.over.iter().map(|text| Axis::parse(text).map_err(|e| e.to_string())).collect()
    }

    fn check(&self) -> Result<(), String> {
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '-';
        if self.name.is_empty() || !self.name.chars().all(plain) {
            return Err("a name is of letters, digits and hyphens".into());
        }
        let axes = self.axes()?;
        for (key, value) in &self.reference {
            let axis = axes.iter().find(|axis| axis.key == *key);
            if !axis.is_some_and(|axis| axis.values.contains(value)) {
                return Err(format!("reference: no axis has {key}={value}"));
            }
        }
        if !self.reference.contains_key(&self.along) {
            return Err(format!("along = `{}` is not in the reference", self.along));
        }
        if self.reference.len() > 3 {
            return Err("a reference of more than three axes can't be shown as a table".into());
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
        assert!(parse("s", right).is_ok());
        for (from, to, named) in [
            ("law='h'", "law='g'", "law=g"),
            ("along='law'", "along='imu'", "`imu`"),
            ("name='a'", "name='../a'", "name"),
            ("law=h,f", "law=h,h", "twice"),
            ("options=''", "option=''", "option"),
        ] {
            let error = parse("s", &right.replace(from, to)).unwrap_err().0;
            assert!(error.starts_with("study s: ") && error.contains(named), "{error}");
        }
    }
}
