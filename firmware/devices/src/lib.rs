//! Hardware-independent part of the device drivers: register values, protocols, and conversion of samples.
//!
//! Plain data and pure functions, tested on the host; a board does the I/O. One module each: [`analog`] (ADC counts to
//! amperes, volts, degrees, radians), [`drv8301`] (gate driver), [`bmi160`] (IMU), [`as5047`] (encoder), [`wheel`]
//! (pulses to a speed with its age), [`switch`] (debounce), [`age`] (age of a sample), [`ticks`] (64-bit clock),
//! [`fault_pin`] (filter of the fault pin), [`rotor_speed`] (rotor below a speed), [`silicon`] (chip revision), [`vesc6`]
//! (constants of one board and its wiring).
#![no_std]
#![forbid(unsafe_code)]

pub mod age;
pub mod analog;
pub mod as5047;
pub mod bmi160;
pub mod drv8301;
pub mod fault_pin;
pub mod rotor_speed;
pub mod silicon;
pub mod switch;
pub mod ticks;
pub mod vesc6;
pub mod wheel;
