//! Files of firmware parameters: exported from a board, read by board commands and simulator.

use super::law;
use crate::board::parameter::{law_bytes, law_points};
use crate::board::settings::Settings;
use crate::parameters;
use crate::range::plain;
use control::{Config, Law};
use link::frame::CRC;
use std::fmt::Write;
use std::path::Path;

/// Description of the files, for help texts.
pub(super) const HELP: &str = "\
FILE is TOML: `law`, a name as in --law or a table of speed_m_s and gain_nm_s_rad, and a table
`parameters` of names and values as in --set. Either can be missing, and any parameter, but not all. An
export also has `count` and `checksum`; to edit it by hand, delete both lines, or it is rejected.";

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
pub(super) struct ParameterFile {
    path: String,
    /// The law.
    pub(super) law: Option<Law>,
    /// Values by key, in the form of `--set`.
    pub(super) values: Vec<(String, String)>,
}

impl ParameterFile {
    /// Reads a file, without checking that its parameters exist and allow these values.
    pub(super) fn read(path: &Path) -> Result<Self, String> {
        let path = path.display().to_string();
        let text = std::fs::read_to_string(&path).map_err(|e| format!("can't read {path}: {e}"))?;
        Self::of_text(&path, &text)
    }

    fn of_text(path: &str, text: &str) -> Result<Self, String> {
        let path = path.to_owned();
        let file: File = toml::from_str(text).map_err(|e| format!("{path}: {}", e.to_string().trim()))?;
        let law = file.law.map(law::of_value).transpose().map_err(|error| format!("{path}: {error}"))?;
        let values = file.parameters.into_iter().map(|(key, value)| match words(&value) {
            _ if key == "law" || key.starts_with("law.") => Err(format!(
                "{path}: parameters: {key}: the law belongs above the parameters, as in law = \"cl2:3\""
            )),
            Some(words) => Ok((key, words)),
            None => Err(format!(
                "{path}: parameters: {key}: expected a number or a word, not {}",
                value.type_str()
            )),
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
    fn checksum(&self) -> String {
        let mut lines: Vec<String> =
            self.values.iter().map(|(key, words)| format!("{key}={words}\n")).collect();
        lines.sort();
        let mut bytes = self.law.as_ref().map_or(Vec::new(), law_bytes);
        bytes.extend(lines.concat().bytes());
        format!("{:08x}", CRC.checksum(&bytes))
    }

    /// Sets the parameters in a simulated controller. The calibration belongs to the board: it is checked and not
    /// applied.
    pub(super) fn apply(&self, config: &mut Config) -> Result<(), String> {
        let calibration = config.calibration;
        let known = parameters::list(config);
        for (key, words) in &self.values {
            if !known.iter().any(|(name, _)| name == key) {
                return Err(format!("{}: {key} = {words}: no parameter {key}", self.path));
            }
            parameters::set(config, key, words)
                .map_err(|error| format!("{}: {key} = {words}: {error}", self.path))?;
        }
        config.calibration = calibration;
        Ok(())
    }
}

/// A value in the form of `--set`.
fn words(value: &toml::Value) -> Option<String> {
    match value {
        toml::Value::String(word) => Some(word.clone()),
        toml::Value::Integer(number) => Some(number.to_string()),
        toml::Value::Float(number) => Some(plain(*number)),
        toml::Value::Boolean(on) => Some(if *on { "on" } else { "off" }.into()),
        _ => None,
    }
}

/// The text of a file with all settings of a board; `remark` is its first line.
///
/// # Errors
/// The written text cannot be read back.
pub(super) fn text(settings: &Settings, remark: &str) -> Result<String, String> {
    let body = body(settings);
    let read = ParameterFile::of_text("export", &body)?;
    let head = format!("count = {}\nchecksum = \"{}\"\n", read.values.len(), read.checksum());
    Ok(format!("# {remark}\n{head}{body}"))
}

fn body(settings: &Settings) -> String {
    let mut text = String::new();
    match law_points(&settings.law) {
        Some(points) => {
            let column = |of: fn(&(f32, f32)) -> f32| points.iter().map(of).collect::<Vec<_>>();
            let (speeds, gains) = (column(|point| point.0), column(|point| point.1));
            let _ = write!(text, "\n[law]\nspeed_m_s = {speeds:?}\ngain_nm_s_rad = {gains:?}\n");
        }
        None => {
            let _ = writeln!(text, "law = \"{}\"", settings.law);
        }
    }
    text += "\n[parameters]\n";
    for one in settings.but_law() {
        let unit = if one.unit.is_empty() { String::new() } else { format!(" {},", one.unit) };
        let _ = writeln!(text, "\"{}\" = {} #{unit} {}", one.key, one.toml(), one.allowed());
    }
    text
}
