//! Flight cards of the devices beside the chip.

mod analog;
mod approximations;
mod drv8301;
mod encoder;
mod fault_pin;
mod imu;
mod rotor_speed;
mod silicon;
mod switch;
mod ticks;
mod vesc6;
mod wheel;
