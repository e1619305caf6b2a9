//! A board at the other end of a line: asked, tuned and watched with the same `link` crate that it is built with.

pub mod causes;
pub mod client;
pub mod compare;
mod controller;
mod error;
pub mod exception;
pub mod fault;
pub mod heard;
pub mod line;
mod link_fault;
mod lockstep;
pub mod monitor;
pub mod parameter;
pub mod printable;
pub mod qemu;
pub mod recorded;
pub mod requests;
pub mod rolling;
pub mod row;
pub mod serial;
pub mod settings;
pub mod told;
pub mod tune;
pub mod virtual_board;
mod watch;

pub use client::{Client, ClientError, Patience};
pub use controller::{Controller, Tally};
pub use error::BoardError;
pub use line::{Line, LineError};
pub use link_fault::{Harm, LinkFault, Way};
pub use lockstep::Lockstep;
pub use requests::BoardName;
