//! Files of firmware parameters: exported from a board, read by board commands and simulator.

use super::law::{self, LawChoiceError};
use crate::board::parameter::law_bytes;
use crate::parameters::{self, SetError, Value};
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

/// A file of parameters that cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterFileError {
    /// The file can't be read.
    #[error("can't read {path}: {reason}")]
    Read {
        /// The file.
        path: String,
        /// The operating system's error.
        reason: String,
    },
    /// The content is wrong.
    #[error("{path}: {error}")]
    Content {
        /// The file.
        path: String,
        /// The error.
        error: Box<ParameterTextError>,
    },
}

/// A text that is no file of parameters.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterTextError {
    /// Not TOML, or an unknown key.
    #[error("{0}")]
    Syntax(String),
    /// A wrong law.
    #[error(transparent)]
    Law(#[from] LawChoiceError),
    /// The law among the parameters.
    #[error("parameters: {0}: the law belongs above the parameters, as in law = \"cl2:3\"")]
    LawAmong(String),
    /// A parameter of a wrong type.
    #[error("parameters: {key}: expected a number or a word, not {found}")]
    Type {
        /// The parameter.
        key: String,
        /// The type found.
        found: &'static str,
    },
    /// Neither a law nor parameters.
    #[error("there is neither `law` nor `parameters` in it")]
    Empty,
    /// Another number of parameters than exported.
    #[error("count = {count}, but it has {found} parameters: it was cut or changed")]
    Count {
        /// The number exported.
        count: usize,
        /// The number found.
        found: usize,
    },
    /// Another content than exported.
    #[error(
        "checksum = \"{checksum}\", but law and parameters have \"{found}\": it was damaged or changed; what was changed \
         on purpose is taken without the lines `count` and `checksum`"
    )]
    Checksum {
        /// The checksum exported.
        checksum: String,
        /// The checksum of the content.
        found: String,
    },
    /// One of count and checksum is missing.
    #[error("`count` and `checksum` must be given together: one is missing")]
    OneMissing,
    /// A parameter that the controller does not have.
    #[error("{key} = {value}: no parameter {key}")]
    Unknown {
        /// The parameter.
        key: String,
        /// Its value.
        value: Value,
    },
    /// A value that the parameter cannot have.
    #[error("{key} = {value}: {error}")]
    Value {
        /// The parameter.
        key: String,
        /// Its value.
        value: Value,
        /// The error.
        error: SetError,
    },
}

impl ParameterTextError {
    /// The error, of the file `path`.
    fn of(self, path: &str) -> ParameterFileError {
        ParameterFileError::Content { path: path.into(), error: Box::new(self) }
    }
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
    ///
    /// # Errors
    /// States file and key, and what is allowed or damaged.
    pub fn read(path: &Path) -> Result<Self, ParameterFileError> {
        let path = path.display().to_string();
        match crate::input_file::text(Path::new(&path)) {
            Ok(text) => Self::of_text(&path, &text),
            Err(error) => Err(ParameterFileError::Read { path, reason: error.to_string() }),
        }
    }

    /// Parses a file's text; `path` names it in errors.
    ///
    /// # Errors
    /// States file and key, and what is allowed or damaged.
    pub fn of_text(path: &str, text: &str) -> Result<Self, ParameterFileError> {
        Self::parse(path, text).map_err(|error| error.of(path))
    }

    fn parse(path: &str, text: &str) -> Result<Self, ParameterTextError> {
        let syntax = |e: toml::de::Error| ParameterTextError::Syntax(e.to_string().trim().into());
        let file: File = toml::from_str(text).map_err(syntax)?;
        let law = file.law.map(law::of_value).transpose()?;
        let values = file.parameters.into_iter().map(|(key, value)| {
            if key == "law" || key.starts_with("law.") {
                return Err(ParameterTextError::LawAmong(key));
            }
            let found = value.type_str();
            match Value::deserialize(value) {
                Ok(value) => Ok((key, value)),
                Err(_) => Err(ParameterTextError::Type { key, found }),
            }
        });
        let values = values.collect::<Result<_, _>>()?;
        let read = Self { path: path.into(), law, values };
        read.check(file.count, file.checksum)?;
        Ok(read)
    }

    /// Checks that an export is complete.
    fn check(&self, count: Option<usize>, checksum: Option<String>) -> Result<(), ParameterTextError> {
        let found = self.values.len();
        if found == 0 && self.law.is_none() {
            return Err(ParameterTextError::Empty);
        }
        match (count, checksum) {
            (None, None) => Ok(()),
            (Some(count), _) if count != found => Err(ParameterTextError::Count { count, found }),
            (Some(_), Some(checksum)) if checksum == self.checksum() => Ok(()),
            (Some(_), Some(checksum)) => {
                Err(ParameterTextError::Checksum { checksum, found: self.checksum() })
            }
            _ => Err(ParameterTextError::OneMissing),
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
    ///
    /// # Errors
    /// An unknown parameter, or a value that it cannot have.
    pub fn apply(&self, config: &mut Config) -> Result<(), ParameterFileError> {
        self.set(config).map_err(|error| error.of(&self.path))
    }

    fn set(&self, config: &mut Config) -> Result<(), ParameterTextError> {
        let calibration = config.calibration;
        let known = parameters::list(config);
        for (key, value) in &self.values {
            let (key, value) = (key.clone(), value.clone());
            if !known.iter().any(|(name, _)| *name == key) {
                return Err(ParameterTextError::Unknown { key, value });
            }
            parameters::set_value(config, &key, &value).map_err(|error| ParameterTextError::Value {
                key,
                value,
                error,
            })?;
        }
        config.calibration = calibration;
        Ok(())
    }
}
