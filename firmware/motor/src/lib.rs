//! The motor's field-oriented current loop: from a steer torque to duty cycles, and the protections around it.
//!
//! # Contract
//! * **Call** [`step`] once each PWM period from the motor's interrupt, with what was sampled in the middle of that
//!   period; its duty cycles are for the whole of the next one. There is no clock inside: time is counted in calls.
//! * **Signs**: torque and steer rate are positive to the right. The motor turns forward when its field goes
//!   a, b, c; current flows into the motor. d lies along the rotor's flux, q a quarter turn ahead.
//! * **Units** are SI and stand in the names. Vectors are peak values of a phase.
//! * **Purity**: plain data in, plain data out; no allocation, no `unsafe`, no panic path, no hardware.
//! * **Total**: every bit pattern of every input gives duty cycles inside the limits, or an open bridge.
//! * **Faults** latch: the bridge opens in the call that sees one, and stays open until a new [`State`].
//!
//! The way of the data, one module each: [`zero`] (the current sensors' zeros) -> [`encoder`] (angle and speed; a
//! [`turn`] is a whole number) -> [`protect`] (what may not go on) -> [`align`] or [`demand`] (which current is wanted) ->
//! [`transform`] (into the rotor's axes and back) -> [`current`] (which voltage) -> [`modulate`] (which duty
//! cycles). [`drive`] puts them together, [`config`] holds what may be chosen, [`machine`] motor and gear, [`fault`] the
//! numbers, [`example`] a motor with its sources. docs/motor.md tells it at length.
#![no_std]
#![forbid(unsafe_code)]

pub mod align;
pub mod angle;
pub mod command_word;
pub mod config;
pub mod current;
pub mod current_offset;
pub mod drive;
pub mod encoder;
pub mod example;
pub mod fault;
pub mod machine;
pub mod modulate;
pub mod protect;
pub mod torque_limit;
pub mod transform;

pub use config::{Config, Plan};
pub use drive::{Inputs, Mode, MotorCommand, Output, State, step};
pub use fault::{FAULTS, Fault, Faults};
pub use protect::sensors::Phases;
