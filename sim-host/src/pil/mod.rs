//! Processor in the loop: a ride whose controller is a board, emulated in QEMU, in lockstep with the simulator.

pub mod compare;
mod controller;
pub mod demo_board;
mod error;
mod link_fault;
mod lockstep;
pub mod qemu;
mod watchdog;

pub use controller::{Controller, Tally};
pub use error::BoardError;
pub use link_fault::{Direction, LinkFault, LinkFaultFormError, LinkFaultKind, LinkFaultTextError};
pub use lockstep::Lockstep;
