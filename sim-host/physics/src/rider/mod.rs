//! Riders: their models (crate `motion`) and the tables of gains that describe them.

pub mod catalogue;
mod compatibility;
mod error;
mod file;
mod fit;
mod line;
mod table;

pub use compatibility::compatibility_warnings;
pub use error::{RiderError, RowError, TableError};
pub use fit::{Fit, mean};
pub use line::Line;
pub use motion::rider::*;
pub use table::{RiderTable, Row};
