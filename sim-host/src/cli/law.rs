//! Laws by name or from a table file.

use control::{Law, LawTable};

/// For help texts.
pub(super) const HELP: &str = "none, h, h-cut (zero above 7.5 m/s), f, g, cl1, cl2:K (K > 0), or a TOML file with speed_m_s and gain_nm_s_rad";

/// A user's gain table as a file.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct TableFile {
    /// Speeds \[m/s\], rising.
    speed_m_s: Vec<f32>,
    /// Gains \[N m s/rad\], positive steering into the fall.
    gain_nm_s_rad: Vec<f32>,
    /// Where they come from.
    #[serde(default, rename = "source")]
    _source: Option<String>,
}

/// The law a name or a file stands for.
pub(super) fn parse(text: &str) -> Result<Law, String> {
    let law = match text {
        "none" => Law::None,
        "h" => Law::H { cut: false },
        "h-cut" => Law::H { cut: true },
        "f" => Law::F,
        "g" => Law::G,
        "cl1" => Law::Cl1,
        _ => match text.strip_prefix("cl2:") {
            Some(k) => Law::Cl2 {
                k: k.parse().map_err(|_| {
                    format!("law `{text}`: `{k}` is not a number; expected cl2:K, K from 0.001 to 20")
                })?,
            },
            None => table(text)?,
        },
    };
    law.validate().map_err(|e| format!("law `{text}`: {e}"))?;
    Ok(law)
}

fn table(path: &str) -> Result<Law, String> {
    if !std::path::Path::new(path).exists() {
        return Err(format!("unknown law `{path}`: no such file, and not one of {HELP}"));
    }
    let text = std::fs::read_to_string(path).map_err(|e| format!("can't read law file {path}: {e}"))?;
    let file: TableFile =
        toml::from_str(&text).map_err(|e| format!("law file {path}: {}", e.to_string().trim()))?;
    let (n, m) = (file.speed_m_s.len(), file.gain_nm_s_rad.len());
    if n != m {
        return Err(format!(
            "law file {path}: speed_m_s has {n} values, gain_nm_s_rad has {m}; they must match"
        ));
    }
    let points: Vec<(f32, f32)> = file.speed_m_s.into_iter().zip(file.gain_nm_s_rad).collect();
    let table = LawTable::new(&points).map_err(|e| {
        let rising = if e.leaf.name.contains("speed") { " (speeds must rise)" } else { "" };
        format!("law file {path}: {e}{rising}")
    })?;
    Ok(Law::Table(table))
}
