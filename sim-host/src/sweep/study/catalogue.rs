//! Studies by name or from TOML files.

use crate::sweep::Axis;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Those that ship: names, and files in `data/studies/`.
const SHIPPED: [(&str, &str); 6] = [
    ("limits", include_str!("../../../../data/studies/limits.toml")),
    ("imu", include_str!("../../../../data/studies/imu.toml")),
    ("compensate", include_str!("../../../../data/studies/compensate.toml")),
    ("tracking", include_str!("../../../../data/studies/tracking.toml")),
    ("speed", include_str!("../../../../data/studies/speed.toml")),
    ("end-stop", include_str!("../../../../data/studies/end-stop.toml")),
];

/// A question and the sweeps that answer it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Study {
    /// Its name, which is that of its files.
    #[serde(skip)]
    pub name: String,
    /// Above the page.
    pub title: String,
    /// What is asked, and how it is answered.
    pub question: String,
    /// What is to be said of the answers; below them.
    #[serde(default)]
    pub remarks: String,
    /// The sweeps.
    #[serde(rename = "sweep")]
    pub parts: Vec<Part>,
}

/// One sweep of a study, and what its answer is.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Its name, which is that of its folder and figures.
    pub name: String,
    /// Above its answer.
    pub title: String,
    /// Said before its answer.
    #[serde(default)]
    pub text: String,
    /// The options of `sweep` that all cells share, and those of the search.
    pub options: String,
    /// The axes, as of `--over`.
    pub over: Vec<String>,
    /// The cell others are compared with: values by key. Axes that are not here tell groups apart, each
    /// with a reference of its own.
    pub reference: BTreeMap<String, String>,
    /// Unit of the numbers along the axis below, if they come without.
    #[serde(default)]
    pub unit: String,
    /// The axis along which is looked for what keeps the area; of words, every value is compared.
    pub along: String,
}

/// A study that can't be done.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct StudyError(pub String);

/// The shipped studies.
pub fn shipped() -> impl Iterator<Item = Result<Study, StudyError>> {
    SHIPPED.iter().map(|(name, text)| parse(name, text))
}

/// A study by `name`: a shipped one, or a `FILE`. Names win over files.
///
/// # Errors
/// Names file and key.
pub fn load(name: &str) -> Result<Study, StudyError> {
    if let Some((name, text)) = SHIPPED.iter().find(|(n, _)| *n == name) {
        return parse(name, text);
    }
    let path = Path::new(name);
    if !path.exists() {
        let known: Vec<&str> = SHIPPED.iter().map(|(name, _)| *name).collect();
        let known = known.join(", ");
        return Err(StudyError(format!("unknown study `{name}`: no such file; shipped are {known}")));
    }
    let text = std::fs::read_to_string(path)
        .map_err(|e| StudyError(format!("can't read study file {name}: {e}")))?;
    let stem = path.file_stem().map_or(name.into(), |s| s.to_string_lossy().into_owned());
    parse(&stem, &text)
}

fn parse(name: &str, text: &str) -> Result<Study, StudyError> {
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
    /// The axis' own.
    pub fn axes(&self) -> Result<Vec<Axis>, String> {
        self.over.iter().map(|text| Axis::parse(text)).collect()
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
    fn shipped_studies_are_right() {
        for study in shipped() {
            assert!(!study.unwrap().parts.is_empty());
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
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
