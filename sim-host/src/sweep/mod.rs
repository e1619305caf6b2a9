//! Basins over a grid of conditions. Cells are computed one by one, on any machine and in any order, and
//! combined to the same bytes.

mod axis;
pub mod document;
mod folder;
mod grid;
mod maps;
mod names;
mod netcdf;
mod plan;
mod run;
mod seal;
mod shard;
mod unit;
mod write;

pub use axis::Axis;
pub use folder::{Folder, PLAN};
pub use grid::Grid;
pub(crate) use maps::AT_LEAST;
pub use maps::pictures;
pub use names::check;
pub use plan::{Plan, SweepSearch, combination, count, label};
pub use run::{Cell, Progress, run};
pub use shard::Shard;
pub use unit::{Found, Unit};
pub use write::write;

/// A sweep that can't be done, with the reason.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct SweepError(pub String);

impl From<crate::report::output::OutputError> for SweepError {
    fn from(error: crate::report::output::OutputError) -> Self {
        Self(error.to_string())
    }
}
