//! The simulator: a nonlinear Whipple bicycle, steered by the flashed control crate. Computes basins of
//! attraction: the disturbances from which a ride does not fall.

pub mod basin;
pub mod bicycle;
pub mod board;
#[cfg(feature = "cli")]
pub mod cli;
pub mod design;
pub mod eigen;
pub mod integrate;
pub mod num;
pub mod parameters;
pub mod pil;
pub mod plant;
pub mod range;
pub mod recording;
pub mod replay;
pub mod report;
pub mod ride;
pub mod rider;
pub mod sensor_fit;
pub mod study;
pub mod sweep;
pub mod thesis;
pub mod tracking;
pub mod weave;
