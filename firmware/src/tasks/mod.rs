//! The tasks that run on every board, and the functions that a board provides.
//!
//! | task | priority | does |
//! | --- | --- | --- |
//! | [`control`] | own executor in an interrupt, above all but clock and motor | the 1 kHz control step |
//! | [`line`] | thread | serial link: parameters, stored faults, telemetry |
//! | [`report`] | thread | logs the last control step once per second |
//! | [`supervise`] | thread | feeds the watchdog while all tasks report |
//!
//! A board is a module that provides:
//!
//! | item | purpose |
//! | --- | --- |
//! | `run` | starts the clock and the executors; the VESC 6 has `start` for the parts that must run before |
//! | `sense`, `drive` | sensors and motor, once per control step |
//! | `report` | one log line |
//! | `serial::read`, `serial::write` | bytes of the serial link |
//! | `flash` | range for the parameters |
//! | `StoreGuard` | while it exists: motor's bridge open, watchdog's timeout extended |
//! | `feed_watchdog`, `heartbeat_lost` | watchdog; whether a task's heartbeat is dropped by fault injection, else false |
//! | `reset_cause`, `outputs_off`, `end` | cause of the start; outputs off; last log line and restart |
//!
//! The board's brown-out warning calls [`crate::crash`].

mod control;
mod host_link;
mod log;
pub mod settings;
mod supervise;

pub use control::control;
pub use host_link::line;
pub use log::report;
pub use supervise::{WATCHDOG, supervise};
