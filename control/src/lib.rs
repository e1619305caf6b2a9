//! The steer-assist controller: everything that decides a torque.
//!
//! # Contract
//! * **Call** [`step`] once per control period (1 kHz by default, [`Config::rate_hz`]), with the
//!   sensors of that instant. There is no clock inside: time is counted in calls.
//! * **Axes** are the benchmark's (Meijaard et al. 2007, SAE): x forward, y right, z down. Roll
//!   rate is positive rolling right, steer torque is positive to the right. The assist steers into
//!   the fall: `T = +gain(v) * roll_rate` with `gain > 0` where it stabilises.
//! * **Units** are SI and stand in the names.
//! * **Purity**: plain data in, plain data out; no allocation, no `unsafe`, no panic path, no
//!   hardware. f32 arithmetic and [`libm`] only, so host and Cortex-M agree in every bit.
//! * **Total**: every bit pattern of every input gives a finite torque inside the limits.
//!
//! The way of the data, one module each: [`frame`] (what the sensors say) -> [`input`] (may it be
//! believed) -> [`history`] (sensors of different latency brought to one instant) -> [`law`] (the
//! wanted torque) -> [`shape`] (what may be asked of the motor,
//! by the table in [`limits`]; [`guard`] judges it). [`controller`] puts them together.
#![no_std]
#![forbid(unsafe_code)]

pub mod controller;
pub mod frame;
pub mod guard;
pub mod history;
pub mod input;
pub mod law;
pub mod limits;
pub mod param;
pub mod real;
pub mod shape;
pub mod wire;

pub use controller::{Command, Config, Plan, State, Status, step};
pub use frame::{Sample, SensorFrame, Wheel};
pub use input::{InputConfig, Reject};
pub use law::{Law, LawTable};
pub use limits::{ActiveLimits, Limits, Taper};
pub use param::ParamError;
