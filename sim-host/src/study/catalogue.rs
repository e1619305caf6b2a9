//! Loads studies by name or from TOML files.

use super::swept::{self, StudyError, parse};
use super::{balance_assist, equal_vaf, prototype};
use std::path::Path;

/// The built-in sweep studies: names, and files in `data/studies/`.
const SWEPT: [(&str, &str); 7] = [
    ("limits", include_str!("../../../data/studies/limits.toml")),
    ("imu", include_str!("../../../data/studies/imu.toml")),
    ("compensate", include_str!("../../../data/studies/compensate.toml")),
    ("tracking", include_str!("../../../data/studies/tracking.toml")),
    ("speed", include_str!("../../../data/studies/speed.toml")),
    ("sensors", include_str!("../../../data/studies/sensors.toml")),
    ("end-stop", include_str!("../../../data/studies/end-stop.toml")),
];

/// A study, by its kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Study {
    /// [`balance_assist`].
    BalanceAssist,
    /// [`equal_vaf`].
    EqualVaf,
    /// [`prototype`].
    Prototype,
    /// Sweeps defined in a TOML file.
    Swept(swept::Study),
}

impl Study {
    /// Its name, equal to its page's name.
    pub fn name(&self) -> &str {
        match self {
            Study::BalanceAssist => balance_assist::NAME,
            Study::EqualVaf => equal_vaf::NAME,
            Study::Prototype => prototype::NAME,
            Study::Swept(study) => &study.name,
        }
    }

    /// Title of its page.
    pub fn title(&self) -> &str {
        match self {
            Study::BalanceAssist => balance_assist::TITLE,
            Study::EqualVaf => equal_vaf::TITLE,
            Study::Prototype => prototype::TITLE,
            Study::Swept(study) => &study.title,
        }
    }

    /// The question that it answers.
    pub fn question(&self) -> &str {
        match self {
            Study::BalanceAssist => balance_assist::QUESTION,
            Study::EqualVaf => equal_vaf::QUESTION,
            Study::Prototype => prototype::QUESTION,
            Study::Swept(study) => study.question.trim(),
        }
    }
}

/// The built-in studies.
///
/// # Errors
/// A built-in file is invalid.
pub fn shipped() -> Result<Vec<Study>, StudyError> {
    let swept = SWEPT.iter().map(|(name, text)| parse(name, text).map(Study::Swept));
    [Study::BalanceAssist, Study::EqualVaf, Study::Prototype].into_iter().map(Ok).chain(swept).collect()
}

/// A study by `name`: a built-in one, or a `FILE`. Names have precedence over files.
///
/// # Errors
/// Names file and key.
pub fn load(name: &str) -> Result<Study, StudyError> {
    let mut shipped = shipped()?;
    if let Some(at) = shipped.iter().position(|study| study.name() == name) {
        return Ok(shipped.swap_remove(at));
    }
    let path = Path::new(name);
    if !path.exists() {
        let known: Vec<&str> = shipped.iter().map(Study::name).collect();
        let known = known.join(", ");
        return Err(StudyError::Unknown { name: name.into(), known });
    }
    let text =
        crate::input_file::text(path).map_err(|error| StudyError::Read { name: name.into(), error })?;
    parse(name, &text).map(Study::Swept)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shipped_studies_are_right() {
        for study in shipped().unwrap() {
            assert!(!study.question().is_empty() && load(study.name()).unwrap() == study);
        }
    }
}
