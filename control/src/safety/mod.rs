//! Whether torque may flow, how much, and an independent check of the result.

pub mod engagement;
pub mod guard;
pub mod limiter;
pub mod limits;
pub mod press;
