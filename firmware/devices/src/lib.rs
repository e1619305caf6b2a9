//! Drivers of the devices around the chip, without the chip: the meaning of their registers, and the conversion of their samples.
//!
//! Everything here is plain data and pure functions, tried on the host; a board moves the bits. One module each:
//! [`analog`] (counts of the converter to amperes, volts, degrees, radians), [`drv8301`] (gate driver), [`bmi160`]
//! (IMU), [`as5047`] (encoder), [`wheel`] (pulses to a speed with its age), [`switch`] (debounced), [`age`] (how old a
//! sample is), [`ticks`] (the clock),
//! [`fault_pin`], [`slow`] (a rotor), [`silicon`] (the chip's revision), [`vesc6`] (a board and its wiring, in numbers).
#![no_std]
#![forbid(unsafe_code)]

pub mod age;
pub mod analog;
pub mod as5047;
pub mod bmi160;
pub mod drv8301;
pub mod fault_pin;
pub mod silicon;
pub mod slow;
pub mod switch;
pub mod ticks;
pub mod vesc6;
pub mod wheel;
