//! Permission, limits and an independent check of the torque.

pub mod engagement;
pub mod guard;
pub mod limiter;
pub mod limits;
pub mod press;
