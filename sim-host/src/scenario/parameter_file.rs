//! Files of firmware parameters: exported from a board, read by board commands and simulator.

use super::law;
use crate::board::parameter::law_bytes;
use crate::parameters::{self, Value};
use control::{Config, Law};
use link::frame::CRC;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    law: Option<toml::Value>,
    #[serde(default)]
    parameters: toml::Table,
    /// Source of the values.
    #[serde(default, rename = "source")]
    _source: Option<String>,
    /// In an export: number of its parameters.
    count: Option<usize>,
    /// In an export: checksum of law and parameters.
    checksum: Option<String>,
}

/// Content of a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ParameterFile {
    /// The file, for messages.
    #[serde(rename = "name")]
    path: String,
    /// The law.
    #[serde(default, skip_serializing_if = "Option::is_none", with = "law_in_place")]
    pub law: Option<Law>,
    /// Values by key.
    #[serde(rename = "parameters")]
    pub values: BTreeMap<String, Value>,
}

/// The law as a name or a table.
mod law_in_place {
    use crate::scenario::content::Content;
    use crate::scenario::law::{self, LawTable};
    use control::Law;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(super) fn serialize<S: Serializer>(law: &Option<Law>, serializer: S) -> Result<S::Ok, S::Error> {
        law.as_ref().map(|law| law::content("table", law)).serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Law>, D::Error> {
        let choice = Content::<LawTable>::deserialize(deserializer)?;
        law::resolve(&choice).map(|(_, law)| Some(law)).map_err(serde::de::Error::custom)
    }
}

impl ParameterFile {
    /// Reads a file, without checking that its parameters exist and allow these values.
    pub fn read(path: &Path) -> Result<Self, String> {
        let path = path.display().to_string();
        let text = std::fs::read_to_string(&path).map_err(|e| format!("can't read {path}: {e}"))?;
        Self::of_text(&path, &text)
    }

    /// Parses a file's text; `path` names it in errors.
    ///
    /// # Errors
    /// States file and key, and what is allowed or damaged.
    pub fn of_text(path: &str, text: &str) -> Result<Self, String> {
        let path = path.to_owned();
        let file: File = toml::from_str(text).map_err(|e| format!("{path}: {}", e.to_string().trim()))?;
        let law = file.law.map(law::of_value).transpose().map_err(|error| format!("{path}: {error}"))?;
        let values = file.parameters.into_iter().map(|(key, value)| {
            if key == "law" || key.starts_with("law.") {
                return Err(format!(
                    "{path}: parameters: {key}: the law belongs above the parameters, as in law = \"cl2:3\""
                ));
            }
            let kind = value.type_str();
            let wrong = |_| format!("{path}: parameters: {key}: expected a number or a word, not {kind}");
            Ok((key.clone(), Value::deserialize(value).map_err(wrong)?))
        });
        let values = values.collect::<Result<_, _>>()?;
        let read = Self { path, law, values };
        read.check(file.count, file.checksum.as_deref())?;
        Ok(read)
    }

    /// Checks that an export is complete.
    fn check(&self, count: Option<usize>, checksum: Option<&str>) -> Result<(), String> {
        let (path, found) = (&self.path, self.values.len());
        if found == 0 && self.law.is_none() {
            return Err(format!("{path}: empty: neither `law` nor `parameters`"));
        }
        match (count, checksum) {
            (None, None) => Ok(()),
            (Some(count), _) if count != found => {
                Err(format!("{path}: count = {count}, but it has {found} parameters: it was cut or changed"))
            }
            (Some(_), Some(checksum)) if checksum == self.checksum() => Ok(()),
            (Some(_), Some(checksum)) => Err(format!(
                "{path}: checksum = \"{checksum}\", but law and parameters have \"{}\": it was damaged or changed; \
                 what was changed on purpose is taken without the lines `count` and `checksum`",
                self.checksum()
            )),
            _ => Err(format!("{path}: `count` and `checksum` must be given together: one is missing")),
        }
    }

    /// Checksum of law and parameters: CRC-32 of the law's bytes and of a line `KEY=WORDS` per parameter, sorted by
    /// key.
    pub fn checksum(&self) -> String {
        let mut lines: Vec<String> =
            self.values.iter().map(|(key, value)| format!("{key}={value}\n")).collect();
        lines.sort();
        let mut bytes = self.law.as_ref().map_or(Vec::new(), law_bytes);
        bytes.extend(lines.concat().bytes());
        format!("{:08x}", CRC.checksum(&bytes))
    }

    /// Sets the parameters in a simulated controller. The calibration belongs to the board: it is checked and not
    /// applied.
    pub fn apply(&self, config: &mut Config) -> Result<(), String> {
        let calibration = config.calibration;
        let known = parameters::list(config);
        for (key, value) in &self.values {
            if !known.iter().any(|(name, _)| name == key) {
                return Err(format!("{}: {key} = {value}: no parameter {key}", self.path));
            }
            parameters::set_value(config, key, value)
                .map_err(|error| format!("{}: {key} = {value}: {error}", self.path))?;
        }
        config.calibration = calibration;
        Ok(())
    }
}
