//! Reads a recorded ride from a file into columns; a map assigns them to sensors later.
//!
//! Formats: text tables, CAN logs (candump, ASC, BLF) and MDF 4; recognised by the first bytes and lines.

pub mod asc;
pub mod bits;
pub mod blf;
pub mod candump;
mod columns;
pub mod database;
#[cfg(feature = "dbc")]
pub mod dbc;
pub mod decode;
pub mod frames;
pub mod mdf;
mod read;
mod remarks;
pub(crate) mod stamp;
pub mod table;

/// The formats of CAN logs that are read.
pub const CAN_LOGS: [&str; 4] = ["candump", "ASC", "BLF", "MDF 4"];

pub use columns::{Column, Group, Recording};
pub use read::{ReadOptions, RecordingError, cut_line, frames, read};
pub use remarks::Remark;
