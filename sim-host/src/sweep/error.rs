//! Errors of a sweep.

use super::plan::PLAN;
use crate::basin::SearchError;
use crate::report::netcdf::NetCdfError;
use crate::report::output::OutputError;
use crate::ride::ConditionsError;
use crate::scenario::search_key;
use std::io;
use std::path::PathBuf;

/// A sweep that can't be done.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SweepError {
    /// A wrong axis.
    #[error("--over {key}: {reason}")]
    Axis {
        /// Its key.
        key: String,
        /// The reason.
        reason: String,
    },
    /// A name that cannot be a variable of the results.
    #[error("--over {key}: the name {reason}")]
    Name {
        /// Key of the axis.
        key: String,
        /// The reason.
        reason: &'static str,
    },
    /// A search that can't be done.
    #[error(transparent)]
    Search(#[from] SearchError),
    /// A cell that can't be simulated.
    #[error(transparent)]
    Conditions(#[from] ConditionsError),
    /// A folder with other content.
    #[error("{} is neither empty nor the folder of a sweep", .0.display())]
    OtherContent(PathBuf),
    /// A folder with another sweep.
    #[error("{} holds another sweep: {difference} ({PLAN}); choose another --out, or empty it", folder.display())]
    OtherSweep {
        /// The folder.
        folder: PathBuf,
        /// The part that differs.
        difference: &'static str,
    },
    /// A folder without a readable plan.
    #[error("{} is not the folder of a sweep: {PLAN}: {error}", folder.display())]
    NoPlan {
        /// The folder.
        folder: PathBuf,
        /// The system's error.
        error: io::Error,
    },
    /// A plan that can't be parsed.
    #[error("{} is not a sweep's plan: {error}", path.display())]
    Plan {
        /// Its file.
        path: PathBuf,
        /// The parser's error.
        error: serde_json::Error,
    },
    /// A plan with another number of cells than its axes have.
    #[error("{}: {cells} cells do not fit the axes", path.display())]
    Cells {
        /// Its file.
        path: PathBuf,
        /// The number of cells.
        cells: usize,
    },
    /// A damaged cell.
    #[error("{} is damaged", .0.display())]
    Damaged(PathBuf),
    /// A file that can't be read.
    #[error("can't read {}: {error}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's error.
        error: io::Error,
    },
    /// A folder that can't be written.
    #[error("can't write to {}: {error}", folder.display())]
    Write {
        /// The folder.
        folder: PathBuf,
        /// The system's error.
        error: io::Error,
    },
    /// A file that can't be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A table that can't be made.
    #[error("can't write CSV: {0}")]
    Csv(#[from] csv::Error),
    /// A document that can't be made.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// A NetCDF file that can't be made.
    #[error(transparent)]
    NetCdf(#[from] NetCdfError),
}

impl SweepError {
    /// Key of the axis or of the search to blame, if it is known.
    pub fn key(&self) -> Option<&str> {
        match self {
            Self::Axis { key, .. } | Self::Name { key, .. } => Some(key),
            Self::Search(error) => Some(search_key(error)),
            _ => None,
        }
    }
}
