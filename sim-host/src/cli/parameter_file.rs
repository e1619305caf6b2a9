//! Writes files of firmware parameters: the export of a board's settings.

use crate::board::parameter::law_points;
use crate::board::settings::Settings;
use crate::scenario::{ParameterFile, ParameterFileError};
use std::fmt::Write;

/// Description of the files, for help texts.
pub(super) const HELP: &str = "\
FILE is TOML: `law`, a name as in --law or a table of speed_m_s and gain_nm_s_rad, and a table \
`parameters` of names and values as in --set. Either can be missing, and any parameter, but not all. An \
export also has `count` and `checksum`; to edit it by hand, delete both lines, or it is rejected.";

/// The text of a file with all settings of a board; `remark` is its first line.
///
/// # Errors
/// The written text cannot be read back.
pub(super) fn text(settings: &Settings, remark: &str) -> Result<String, ParameterFileError> {
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
