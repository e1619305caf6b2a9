//! Loads riders by name or from TOML files.

use super::{RiderError, RiderTable};
use std::path::Path;

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
        crate::input_file::text(path).map_err(|source| RiderError::Read { path: path.into(), source })?;
    RiderTable::from_text(name, &text, path)
}
