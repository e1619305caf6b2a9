//! A board at the other end of a line.

pub mod compare;
mod controller;
mod error;
pub mod line;
mod link_fault;
mod lockstep;
pub mod qemu;
mod watch;

pub use controller::{Controller, Tally};
pub use error::BoardError;
pub use line::{Line, LineError};
pub use link_fault::{Harm, LinkFault, Way};
pub use lockstep::Lockstep;
