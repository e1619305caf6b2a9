//! Boards at the other end of a line: requests, tuning and monitoring, with the same `link` crate as the firmware.

pub mod causes;
pub mod client;
pub mod compare;
mod controller;
pub mod demo_board;
mod error;
pub mod exception;
pub mod fault;
mod link_fault;
mod lockstep;
pub mod monitor;
pub mod parameter;
pub mod printable;
pub mod qemu;
pub mod received;
pub mod reception;
pub mod recorded;
pub mod requests;
pub mod serial;
pub mod settings;
pub mod telemetry_row;
pub mod transport;
pub mod tune;
pub mod virtual_board;
mod watchdog;

pub use client::{Client, ClientError, RetryPolicy};
pub use controller::{Controller, Tally};
pub use error::BoardError;
pub use link_fault::{Direction, LinkFault, LinkFaultKind};
pub use lockstep::Lockstep;
pub use requests::BoardName;
pub use transport::{Transport, TransportError};
