//! The steer-assist controller: everything that decides a torque.
//!
//! # Contract
//! * **Call** [`step`] once per control period (1 kHz by default, [`Config::rate_hz`]), with the
//!   sensors of that instant. There is no clock inside: time is counted in calls, and what really
//!   passed stands in the frame.
//! * **Axes** are the benchmark's (Meijaard et al. 2007, SAE): x forward, y right, z down. Roll
//!   rate is positive rolling right, steer torque is positive to the right. The assist steers into
//!   the fall: `T = +gain(v) * roll_rate` with `gain > 0` where it stabilises.
//! * **Units** are SI and stand in the names.
//! * **Purity**: plain data in, plain data out; no allocation, no `unsafe`, no panic path, no
//!   hardware. f32 arithmetic and [`libm`] only, so host and Cortex-M agree in every bit.
//! * **Total**: every bit pattern of every input gives a finite torque inside the limits.
//!
//! The way of the data, one module each: [`frame`] (what the sensors say) -> [`calibrate`] (in the
//! bicycle's axes) -> [`input`] (may it be believed; [`watch`] is one sensor) -> [`estimate`] (the motion)
//! -> [`cross`] (do the sensors fit each other) -> [`response`] (do gyro and motor act with the right sign;
//! by a [`slope`]) -> [`polarity`] (the check before the first ride) -> [`permit`] (may torque flow, and why not) ->
//! [`predict`] (as it will be when the torque acts) -> [`smooth`] (without steps and vibration) -> [`history`] (sensors of different latency brought
//! to one instant) -> [`law`] (the wanted torque; [`table`] for one of a user's own, [`capsize`] and
//! [`track`] for what may be added to it) -> [`shape`] (inside the
//! [`limits`]) -> [`guard`] (judges it by them). [`controller`] puts them together, [`config`] holds what
//! may be chosen, [`fault`] numbers what can go wrong, [`param`] declares every parameter. A board makes
//! wheel speeds of [`pulses`].
#![no_std]
#![forbid(unsafe_code)]

pub mod calibrate;
pub mod capsize;
pub mod config;
pub mod controller;
pub mod cross;
pub mod estimate;
pub mod fault;
pub mod frame;
pub mod guard;
pub mod history;
pub mod input;
pub mod law;
pub mod limits;
pub mod maths;
pub mod param;
pub mod permit;
pub mod polarity;
pub mod predict;
pub mod press;
pub mod pulses;
pub mod real;
pub mod response;
pub mod shape;
pub mod slope;
pub mod smooth;
pub mod table;
pub mod track;
pub mod watch;
pub mod wire;

pub use calibrate::Calibration;
pub use capsize::Capsize;
pub use config::Config;
pub use controller::{Command, Plan, State, step};
pub use fault::{CAUSES, Cause, Causes};
pub use frame::{Sample, SensorFrame, Triple, Wheel};
pub use input::InputConfig;
pub use law::Law;
pub use limits::{ActiveLimits, Limits, Taper};
pub use param::ParamError;
pub use permit::{Mode, PermitConfig};
pub use table::LawTable;
pub use watch::{Loss, Sensor};
