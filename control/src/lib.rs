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
//! One step runs through four folders:
//!
//! * [`sensors`]: a [`SensorFrame`] becomes measurements in the bicycle's axes ([`sensors::calibration`]) of which each was checked
//!   on its own ([`sensors::validation`], one [`sensors::monitor`] a sensor) and against the others ([`sensors::cross_check`],
//!   [`sensors::sign_check`], [`sensors::polarity`]).
//! * [`estimate`]: the motion of the bicycle and how sure it is, smoothed and predicted to the instant at which the torque acts.
//! * [`law`]: the torque of the chosen roll-rate law, and of [`law::capsize`] and [`law::path_tracking`] where they are on.
//! * [`safety`]: whether torque may flow and why not ([`safety::engagement`]), the torque inside the [`safety::limits`]
//!   ([`safety::limiter`]), and a check of the result by a second formulation ([`safety::guard`]).
//!
//! [`controller`] calls them in order, [`config`] holds every choice, [`plan`] what follows from it, [`fault`] numbers what can go
//! wrong, [`param`] declares every parameter with its range, [`wire`] encodes frames and configurations.
#![no_std]
#![forbid(unsafe_code)]

pub mod config;
pub mod controller;
pub mod estimate;
pub mod fault;
pub mod law;
pub mod maths;
pub mod param;
pub mod plan;
pub mod safety;
pub mod sensors;
pub mod wire;

pub use config::Config;
pub use controller::{Command, State, step};
pub use fault::{CAUSES, Cause, Causes};
pub use law::Law;
pub use law::capsize::Capsize;
pub use law::gain_schedule::GainSchedule;
pub use param::ParamError;
pub use plan::Plan;
pub use safety::engagement::{EngagementConfig, Mode};
pub use safety::limits::{ActiveLimits, Limits, Taper};
pub use sensors::calibration::Calibration;
pub use sensors::frame::{Sample, SensorFrame, Triple, Wheel};
pub use sensors::monitor::{Loss, Sensor};
pub use sensors::validation::ValidationConfig;
