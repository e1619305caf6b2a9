//! The law of a scenario: a name, a table file, or a table in place.

use super::content::Content;
use control::law::{LAWS, LawError};
use control::param::ParamSpec;
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
    // The shortest decimal number that is the same single: 0.1, not 0.10000000149011612.
    let exact = |x: f32| x.to_string().parse().unwrap_or_else(|_| f64::from(x));
    let points = table.points();
    Content::Given(Box::new(LawTable {
        name: Some(name.into()),
        speed_m_s: points.iter().map(|point| exact(point.0)).collect(),
        gain_nm_s_rad: points.iter().map(|point| exact(point.1)).collect(),
        source: None,
    }))
}

/// The law of a scenario, and its name in results.
///
/// # Errors
/// States the law, its number and range, or file and value.
pub(super) fn resolve(choice: &Content<LawTable>) -> Result<(String, Law), String> {
    match choice {
        Content::Named(name) => Ok((name.clone(), parse(name)?)),
        Content::Given(table) => {
            let name = table.name.clone().unwrap_or_else(|| "table".into());
            if name.parse::<Law>().is_ok() {
                return Err(format!(
                    "law: `{name}` is the name of a built-in law; choose another for the table"
                ));
            }
            let law = of_table((**table).clone(), &format!("law {name}"))?;
            Ok((name, law))
        }
    }
}

/// The law with this name or from this file.
pub fn parse(text: &str) -> Result<Law, String> {
    let name = text.split_once(':').map_or(text, |(name, _)| name);
    text.parse::<Law>().or_else(|error| match error {
        LawError::Unknown => table(text),
        LawError::NotANumber(ParamSpec { min, max, .. }) => {
            Err(format!("law `{text}`: expected {name}:K, K a number from {min} to {max}"))
        }
        LawError::NoParameter => Err(format!("law `{text}`: {name} takes no number")),
        LawError::OutOfRange(error) => Err(format!("law `{text}`: {error}")),
    })
}

/// The capsize term of `K:V`.
pub fn capsize(text: &str) -> Result<Capsize, String> {
    let numbers = text.split_once(':').and_then(|(k, v)| Some((k.parse().ok()?, v.parse().ok()?)));
    let (k_c, v_max_m_s) =
        numbers.ok_or_else(|| format!("`{text}` is not K:V, N s/rad and m/s, for example 0.7:6.5"))?;
    let capsize = Capsize { k_c, v_max_m_s };
    capsize.validate().map_err(|e| e.to_string())?;
    Ok(capsize)
}

/// The law in a parameter file: a name, or a table.
pub(super) fn of_value(value: toml::Value) -> Result<Law, String> {
    match value {
        toml::Value::String(name) => match parse(&name) {
            Ok(Law::Table(_)) => Err(format!("law `{name}` is a file; insert its table here")),
            law => law,
        },
        table => {
            of_table(table.try_into().map_err(|e: toml::de::Error| format!("law: {}", e.message()))?, "law")
        }
    }
}

fn table(path: &str) -> Result<Law, String> {
    if !std::path::Path::new(path).exists() {
        return Err(format!("unknown law `{path}`: no such file, and not one of {}", allowed()));
    }
    let text = std::fs::read_to_string(path).map_err(|e| format!("can't read law file {path}: {e}"))?;
    let file: LawTable =
        toml::from_str(&text).map_err(|e| format!("law file {path}: {}", e.to_string().trim()))?;
    of_table(file, &format!("law file {path}"))
}

fn of_table(file: LawTable, place: &str) -> Result<Law, String> {
    let (n, m) = (file.speed_m_s.len(), file.gain_nm_s_rad.len());
    if n != m {
        return Err(format!("{place}: speed_m_s has {n} values, gain_nm_s_rad has {m}; they must match"));
    }
    let points = file.speed_m_s.into_iter().zip(file.gain_nm_s_rad);
    let points: Vec<(f32, f32)> = points.map(|(speed, gain)| (speed as f32, gain as f32)).collect();
    let table = GainSchedule::new(&points).map_err(|e| {
        let rising = if e.leaf.name.contains("speed") { " (speeds must rise)" } else { "" };
        format!("{place}: {e}{rising}")
    })?;
    Ok(Law::Table(table))
}
