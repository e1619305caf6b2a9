//! The steer-assist controller: computes the motor's steer torque from the sensors' samples.
//!
//! * **Call** [`step`] once per control period (1 kHz by default, [`Config::rate_hz`]) with the sensors' samples of
//!   that instant. The crate reads no clock: durations are counted in control periods, and the measured time is in the
//!   frame.
//! * **Axes** are the benchmark's (Meijaard et al. 2007, SAE): x forward, y right, z down. Roll rate is positive when
//!   rolling to the right, steer torque is positive to the right. The assist steers into the fall:
//!   `T = +gain(v) * roll_rate` with `gain > 0` where it stabilises.
//! * **Units** are SI and part of the names.
//! * **Purity**: plain data in, plain data out; no allocation, no `unsafe`, no panic path, no hardware. f32 arithmetic
//!   and [`libm`] only, so host and Cortex-M results are bit-identical.
//! * **Total**: every bit pattern of every input gives a finite torque inside the limits.
//!
//! One step runs through four modules:
//!
//! * [`sensors`]: converts a [`SensorFrame`] to measurements in the bicycle's axes ([`sensors::calibration`]). Each
//!   sensor is checked on its own ([`sensors::validation`], one [`sensors::monitor`] per sensor) and against the other
//!   sensors ([`sensors::cross_check`], [`sensors::sign_check`], [`sensors::polarity`]).
//!   [`sensors::latency`] aligns samples of different latency to one instant.
//! * [`estimate`]: estimates the motion of the bicycle with an error bound, predicts the roll rate to the instant at
//!   which the torque acts, and smooths it.
//! * [`law`]: computes the torque of the chosen roll-rate law, behind its [`law::dead_band`], and of [`law::capsize`] and
//!   [`law::path_tracking`] where they are on.
//! * [`safety`]: decides whether torque is permitted ([`safety::engagement`]), keeps the torque inside the
//!   [`safety::limits`] ([`safety::limiter`]) and checks the result by a second formulation ([`safety::guard`]).
//!
//! [`controller`] calls them in order. [`config`] holds all parameters, [`plan`] the constants derived from them,
//! [`fault`] the numbered causes; [`param`] declares every parameter with its range, [`mod@numbered`]
//! enums with permanent numbers, [`wire`] encodes frames, commands and configurations. A board computes wheel speeds from pulses by [`sensors::wheel_speed`].
//!
//! ```
//! use control::{Config, Law, Sample, SensorFrame, State, Triple, step};
//!
//! let plan = Config::thesis(Law::H { cut: false }).plan().unwrap();
//! let mut state = State::default();
//! let mut frame = SensorFrame {
//!     gyro_rad_s: Triple::fresh([0.1, 0.0, 0.0]),
//!     front_wheel_m_s: Sample::fresh(4.0),
//!     ..SensorFrame::missing()
//! };
//! let mut torque_nm = 0.0;
//! // The switch is first open, then pressed; the assist engages after its self-test.
//! for period in 0..2000_u32 {
//!     frame.now_us = 1000 * period;
//!     frame.engage = period > 1000;
//!     torque_nm = step(&plan, &mut state, &frame).torque_nm;
//! }
//! // h(4 m/s) = (30 - 16) exp(-0.48) = 8.66 N m s/rad, times a roll rate of 0.1 rad/s to the right.
//! assert!((torque_nm - 0.866).abs() < 0.001);
//! ```
#![no_std]
#![forbid(unsafe_code)]

pub mod command;
pub mod config;
pub mod controller;
pub mod estimate;
pub mod fault;
pub mod law;
pub mod maths;
pub mod numbered;
pub mod param;
pub mod plan;
pub mod safety;
pub mod sensors;
pub mod wire;

pub use command::Command;
pub use config::Config;
pub use controller::{State, step};
pub use fault::{CAUSES, Cause, Causes};
pub use law::Law;
pub use law::capsize::Capsize;
pub use law::dead_band::DeadBand;
pub use law::gain_schedule::GainSchedule;
pub use param::ParamError;
pub use plan::Plan;
pub use safety::engagement::{EngagementConfig, Mode};
pub use safety::limits::{ActiveLimits, LIMITS, Limits, NamedLimit, Taper};
pub use sensors::calibration::Calibration;
pub use sensors::frame::{Sample, SensorFrame, Triple, Wheel};
pub use sensors::monitor::{Loss, Sensor};
pub use sensors::validation::ValidationConfig;
