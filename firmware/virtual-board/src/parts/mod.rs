//! The parts beside the chip, at the level of their serial words.

pub mod as5047;
pub mod bmi160;
pub mod drv8301;
mod low_pass;
mod shift;
