//! Loads riders by name or from TOML files.

use super::table::RiderTable;
use std::path::{Path, PathBuf};

/// Names and texts of the shipped riders in `data/riders/`.
const SHIPPED: [(&str, &str); 10] = [
    ("young", include_str!("../../../../data/riders/young.toml")),
    ("smart", include_str!("../../../../data/riders/smart.toml")),
    ("smart6", include_str!("../../../../data/riders/smart6.toml")),
    ("undelayed", include_str!("../../../../data/riders/undelayed.toml")),
    ("undelayed-alt", include_str!("../../../../data/riders/undelayed-alt.toml")),
    ("hess", include_str!("../../../../data/riders/hess.toml")),
    ("hess-benchmark", include_str!("../../../../data/riders/hess-benchmark.toml")),
    ("young-reduction", include_str!("../../../../data/riders/young-reduction.toml")),
    ("smart-reduction", include_str!("../../../../data/riders/smart-reduction.toml")),
    ("undelayed-reduction", include_str!("../../../../data/riders/undelayed-reduction.toml")),
];

/// Reason why a rider cannot be loaded.
#[derive(Debug, thiserror::Error)]
pub enum RiderError {
    /// Neither a shipped name nor a file.
    #[error("unknown rider `{name}`: no such file, and no such shipped rider; shipped are {known}")]
    Unknown {
        /// As given.
        name: String,
        /// The shipped names.
        known: String,
    },
    /// The file can't be read.
    #[error("can't read rider file {path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The operating system's error.
        source: std::io::Error,
    },
    /// The file is not TOML, or a key is missing, unknown or of a wrong type.
    #[error("rider file {path}: {reason}")]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The parser's message, with line and column.
        reason: String,
    },
    /// A value is wrong.
    #[error("rider file {path}: {reason}")]
    Table {
        /// The file.
        path: PathBuf,
        /// Key or row, value and range.
        reason: String,
    },
}

/// Names of the shipped riders.
pub fn shipped_names() -> impl Iterator<Item = &'static str> {
    SHIPPED.iter().map(|(name, _)| *name)
}

/// Loads a rider by `name`: a shipped one, or a `FILE`. Shipped names take precedence.
///
/// # Errors
/// States file, key, row, value and allowed range.
pub fn load(name: &str) -> Result<RiderTable, RiderError> {
    if let Some((_, text)) = SHIPPED.iter().find(|(n, _)| *n == name) {
        return RiderTable::from_text(name, text, Path::new(&format!("data/riders/{name}.toml")));
    }
    let path = Path::new(name);
    if !path.exists() {
        let known = shipped_names().collect::<Vec<_>>().join(", ");
        return Err(RiderError::Unknown { name: name.into(), known });
    }
    let text =
        std::fs::read_to_string(path).map_err(|source| RiderError::Read { path: path.into(), source })?;
    RiderTable::from_text(name, &text, path)
}
