//! Riders: their models (crate `motion`) and the tables of gains that describe them.

pub mod catalogue;
mod compatibility;
mod covariance;
mod draw;
mod error;
mod file;
mod fit;
mod line;
mod merge;
mod spline;
mod table;

pub use compatibility::compatibility_warnings;
pub use covariance::Covariance;
pub use draw::Drawing;
pub use error::{CovarianceError, DrawError, MergeError, RiderError, RowError, TableError};
pub use fit::{Fit, mean};
pub use line::Line;
pub use merge::merge;
pub use motion::rider::*;
pub use spline::{Point, Spline, Variances};
pub use table::{RiderTable, Row};
