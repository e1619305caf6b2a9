//! Devices beside the chip, modelled at the level of their SPI words.

pub mod as5047;
pub mod bmi160;
pub mod drv8301;
mod low_pass;
mod shift;
