//! What runs on every board.
//!
//! | task | priority | does |
//! | --- | --- | --- |
//! | [`control`] | its own executor in an interrupt, above all but clock and motor | the 1 kHz step |
//! | [`line`] | thread | the engineer's line: parameters, kept faults, telemetry |
//! | [`report`] | thread | says once a second what the control task did |
//! | [`supervise`] | thread | feeds the watchdog while all tasks report |
//!
//! A board is a module with these functions: `run` (starts the clock and the executors; what must run before, the board of
//! the chip starts with `start`), `sense`
//! and `drive` (the sensors and the motor, at every step), `report` (one line to the engineer),
//! `host_link::read` and `host_link::write` (bytes from and to the engineer's computer), `flash` (where parameters
//! are kept; it gives the watchdog more patience while it erases), `feed_watchdog`, `reset_cause`, `outputs_off` and `end`
//! (the last words, then a new start). Its warning of a failing supply ends in [`crate::crash`].

mod control;
mod host_link;
mod log;
pub mod settings;
mod supervise;

pub use control::{Refusal, Telemetry, commanded, control, latest};
pub use host_link::line;
pub use log::report;
pub use supervise::{WATCHDOG, supervise};
