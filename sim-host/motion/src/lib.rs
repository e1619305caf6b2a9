//! The motion of a ride: the nonlinear bicycle with rider, sensors and actuator, steered by the flashed control crate,
//! and its integration, eight rides at once.
//!
//! Compiled for speed. Files and basins are in the crate `physics`, which passes these modules on.

pub mod bicycle;
pub mod integrate;
pub mod num;
pub mod plant;
pub mod range;
pub mod ride;
pub mod rider;
