//! Parameters of the flashed code in a file: what a board exports, and what board and simulator take.

use super::law;
use crate::board::parameter::{law_name, law_points};
use crate::board::settings::Settings;
use crate::leaves;
use crate::range::plain;
use control::{Config, Law};
use std::fmt::Write;
use std::path::Path;

/// For help texts.
pub(super) const HELP: &str = "\
FILE is TOML: `law`, a name as of --law or a table of speed_m_s and gain_nm_s_rad, and a table
`parameters` of names and values as of --set. Either may be missing, and any parameter.";

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    law: Option<toml::Value>,
    #[serde(default)]
    parameters: toml::Table,
    /// Where they come from.
    #[serde(default, rename = "source")]
    _source: Option<String>,
}

/// What a file says.
pub(super) struct ParameterFile {
    path: String,
    /// The law.
    pub(super) law: Option<Law>,
    /// Values by key, in the words of `--set`.
    pub(super) values: Vec<(String, String)>,
}

impl ParameterFile {
    /// Reads a file; that its parameters exist and may have these values is not checked yet.
    pub(super) fn read(path: &Path) -> Result<Self, String> {
        let path = path.display().to_string();
        let text = std::fs::read_to_string(&path).map_err(|e| format!("can't read {path}: {e}"))?;
        let file: File = toml::from_str(&text).map_err(|e| format!("{path}: {}", e.to_string().trim()))?;
        let law = file.law.map(law::of_value).transpose().map_err(|why| format!("{path}: {why}"))?;
        let values = file.parameters.into_iter().map(|(key, value)| match words(&value) {
            _ if key == "law" || key.starts_with("law.") => Err(format!(
                "{path}: parameters: {key}: the law stands above the parameters, as in law = \"cl2:3\""
            )),
            Some(words) => Ok((key, words)),
            None => Err(format!(
                "{path}: parameters: {key}: expected a number or a word, not {}",
                value.type_str()
            )),
        });
        let values = values.collect::<Result<_, _>>()?;
        Ok(Self { path, law, values })
    }

    /// Puts its parameters into a simulated controller. The calibration is that of the board alone: it is checked, and
    /// left out.
    pub(super) fn apply(&self, config: &mut Config) -> Result<(), String> {
        let calibration = config.calibration;
        let known = leaves::list(config);
        for (key, words) in &self.values {
            if !known.iter().any(|(name, _)| name == key) {
                return Err(format!("{}: {key} = {words}: no parameter {key}", self.path));
            }
            leaves::set(config, key, words)
                .map_err(|why| format!("{}: {key} = {words}: {why}", self.path))?;
        }
        config.calibration = calibration;
        Ok(())
    }
}

/// A value in the words of `--set`.
fn words(value: &toml::Value) -> Option<String> {
    match value {
        toml::Value::String(word) => Some(word.clone()),
        toml::Value::Integer(number) => Some(number.to_string()),
        toml::Value::Float(number) => Some(plain(*number)),
        toml::Value::Boolean(on) => Some(if *on { "on" } else { "off" }.into()),
        _ => None,
    }
}

/// A file of all that a board has, with `remark` as its first line.
pub(super) fn text(settings: &Settings, remark: &str) -> String {
    let mut text = format!("# {remark}\n");
    match law_points(&settings.law) {
        Some(points) => {
            let column = |of: fn(&(f32, f32)) -> f32| points.iter().map(of).collect::<Vec<_>>();
            let (speeds, gains) = (column(|point| point.0), column(|point| point.1));
            let _ = write!(text, "\n[law]\nspeed_m_s = {speeds:?}\ngain_nm_s_rad = {gains:?}\n");
        }
        None => {
            let _ = writeln!(text, "law = \"{}\"", law_name(&settings.law));
        }
    }
    text += "\n[parameters]\n";
    for one in settings.but_law() {
        let unit = if one.unit.is_empty() { String::new() } else { format!(" {},", one.unit) };
        let _ = writeln!(text, "\"{}\" = {} #{unit} {}", one.key, one.toml(), one.allowed());
    }
    text
}
