//! Options that tell how to read recordings.

use super::Failure;
use crate::recording::ReadOptions;
use crate::replay::Map;
use std::path::PathBuf;

/// Map and databases of recordings.
#[derive(clap::Args)]
pub(super) struct RecordingArgs {
    /// Assignment of the columns: the name of a built-in map, or a FILE [default: by the columns]
    #[arg(long, value_name = "NAME|FILE")]
    pub(super) map: Option<String>,
    /// Database that decodes CAN frames; may be repeated
    #[arg(long, value_name = "FILE")]
    dbc: Vec<PathBuf>,
}

impl RecordingArgs {
    /// The given map.
    ///
    /// # Errors
    /// The file with key and value.
    pub(super) fn map(&self) -> Result<Option<Map>, Failure> {
        Ok(self.map.as_deref().map(Map::load).transpose().map_err(|error| format!("--map {error}"))?)
    }

    /// The given map's name, for a document.
    pub(super) fn map_name(&self) -> String {
        self.map.clone().unwrap_or_else(|| "by the columns".into())
    }

    /// Options of reading.
    pub(super) fn options(&self) -> ReadOptions {
        ReadOptions { strict: false, dbc: self.dbc.clone() }
    }
}
