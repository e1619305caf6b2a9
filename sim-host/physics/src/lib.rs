//! The physics of the simulator: a nonlinear Whipple bicycle with rider, sensors and actuator, steered by the flashed
//! control crate; its rides, basins of attraction and eigenvalues.

pub mod basin;
pub mod bicycle;
pub mod eigen;
pub mod integrate;
pub mod num;
pub mod plant;
pub mod range;
pub mod ride;
pub mod rider;
pub mod tracking;
