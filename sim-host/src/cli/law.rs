//! Parses laws: a name or a table file.

use control::law::{LAWS, LawError};
use control::param::ParamSpec;
use control::{Capsize, GainSchedule, Law};

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

/// A user's gain table as a file.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct TableFile {
    /// Speeds \[m/s\], rising.
    speed_m_s: Vec<f32>,
    /// Gains \[N m s/rad\], positive steering into the fall.
    gain_nm_s_rad: Vec<f32>,
    /// Source of the values.
    #[serde(default, rename = "source")]
    _source: Option<String>,
}

/// The law with this name or from this file.
pub(super) fn parse(text: &str) -> Result<Law, String> {
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
pub(super) fn capsize(text: &str) -> Result<Capsize, String> {
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
    let file: TableFile =
        toml::from_str(&text).map_err(|e| format!("law file {path}: {}", e.to_string().trim()))?;
    of_table(file, &format!("law file {path}"))
}

fn of_table(file: TableFile, place: &str) -> Result<Law, String> {
    let (n, m) = (file.speed_m_s.len(), file.gain_nm_s_rad.len());
    if n != m {
        return Err(format!("{place}: speed_m_s has {n} values, gain_nm_s_rad has {m}; they must match"));
    }
    let points: Vec<(f32, f32)> = file.speed_m_s.into_iter().zip(file.gain_nm_s_rad).collect();
    let table = GainSchedule::new(&points).map_err(|e| {
        let rising = if e.leaf.name.contains("speed") { " (speeds must rise)" } else { "" };
        format!("{place}: {e}{rising}")
    })?;
    Ok(Law::Table(table))
}
