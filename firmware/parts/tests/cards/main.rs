//! Flight cards of the parts around the chip.

mod analog;
mod approximations;
mod bit_timing;
mod broadcast;
mod drv8301;
mod encoder;
mod fault_pin;
mod imu;
mod mailbox;
mod order;
mod silicon;
mod slow;
mod switch;
mod ticks;
mod vesc6;
mod wheel;
