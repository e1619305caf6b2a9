//! Basins over a grid of conditions. Cells are computed one by one, on any machine and in any order, and
//! combined to the same bytes.

mod axis;
mod claim;
mod claims;
pub mod document;
mod error;
mod folder;
mod grid;
mod maps;
mod names;
mod netcdf;
mod plan;
mod queue;
mod run;
mod seal;
mod shard;
pub mod status;
mod unit;
mod wait;
mod worker;
mod write;

pub use axis::{Axis, AxisError, AxisUnit, ItemError};
pub use claim::{Claim, DoneColumn, RENEWAL, STALE, State};
pub use claims::Claims;
pub use error::SweepError;
pub use folder::Folder;
pub use grid::Grid;
pub(crate) use maps::AT_LEAST;
pub use maps::pictures;
pub use names::check;
pub use plan::{PLAN, Plan, SweepSearch, combination, count, label};
pub use run::{Cell, Done, Progress, run};
pub use seal::sha256;
pub use shard::{Shard, ShardError};
pub use unit::{Found, Unit};
pub use wait::{Holder, Reminder, Wait, in_the_future};
pub use worker::Worker;
pub use write::write;
