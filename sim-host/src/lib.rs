//! The simulator: a nonlinear Whipple bicycle, steered by the flashed control crate. Computes basins of
//! attraction: the disturbances from which a ride does not fall.

pub mod board;
#[cfg(feature = "cli")]
pub mod cli;
pub mod design;
pub mod parameters;
pub mod pil;
pub mod recording;
pub mod replay;
pub mod report;
pub mod scenario;
pub mod sensor_fit;
pub mod study;
pub mod sweep;
pub mod thesis;
pub mod weave;

use physics::range;
pub use physics::{basin, bicycle, eigen, integrate, num, plant, ride, rider, tracking};
