//! Client for a board on a serial link: requests, tuning and monitoring, with the same `link` crate as the firmware.

pub mod broadcast;
pub mod causes;
pub mod client;
pub mod exception;
pub mod fault;
pub mod monitor;
pub mod parameter;
pub mod printable;
pub mod received;
pub mod reception;
pub mod recorded;
pub mod requests;
pub mod serial;
pub mod settings;
pub mod socketcan;
pub mod telemetry_row;
pub mod transport;
pub mod tune;
pub mod virtual_board;

pub use client::{Client, ClientError, RetryPolicy};
pub use requests::BoardName;
pub use transport::{Transport, TransportError};
