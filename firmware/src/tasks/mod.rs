//! What runs on every board.
//!
//! | task | priority | does |
//! | --- | --- | --- |
//! | [`control`] | its own executor in an interrupt, above all but the clock | the 1 kHz step |
//! | [`supervise`] | thread | feeds the watchdog while steps are being done |
//! | [`report`] | thread | says once a second what the control task did |
//!
//! A board is a module with these functions: `run` (starts the clock and both executors), `sense`
//! and `drive` (the sensors and the motor, at every step), `report` (one line to the engineer)
//! and `feed_watchdog`.

mod control;
mod report;
mod supervise;

pub use control::{Refusal, Telemetry, control, latest};
pub use report::report;
pub use supervise::{WATCHDOG, supervise};
