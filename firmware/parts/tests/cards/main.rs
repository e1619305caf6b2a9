//! Flight cards of the parts around the chip.

mod analog;
mod drv8301;
mod encoder;
mod imu;
mod order;
mod switch;
mod vesc6;
mod wheel;
