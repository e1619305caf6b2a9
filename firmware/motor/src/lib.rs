//! Field-oriented current loop of the motor: from a steer torque to duty cycles, with the protections around it.
//!
//! # Contract
//! * **Call** [`step`] once per PWM period from the motor interrupt, with the values sampled in the middle of that
//!   period; its duty cycles apply to the whole next one. There is no clock inside: time is counted in calls.
//! * **Signs**: torque and steer rate are positive to the right. The motor turns forward when its field goes
//!   a, b, c; current flows into the motor. d lies along the rotor's flux, q a quarter turn ahead.
//! * **Units** are SI and part of the names. Vectors are peak values of a phase.
//! * **Purity**: plain data in, plain data out; no allocation, no `unsafe`, no panic path, no hardware.
//! * **Total**: every bit pattern of every input gives duty cycles inside the limits, or an open bridge.
//! * **Faults** latch: the bridge opens in the call that detects a fault, and stays open until a new [`State`].
//!
//! Data flow, one module each: [`current_offset`] (offsets of the current sensors) -> [`encoder`] (angle and speed; an
//! [`angle`] is an integer) -> [`protect`] (checks and current limits) -> [`align`] or [`torque_limit`] (current
//! set-point) -> [`transform`] (to and from dq axes) -> [`current`] (voltage) -> [`modulate`] (duty cycles). [`drive`]
//! combines them. [`config`] has the parameters, [`machine`] motor and gear, [`command_word`] the command from control,
//! [`fault`] the numbers, [`example`] a motor with its sources. Details: docs/motor.md.
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
