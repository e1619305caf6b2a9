//! The board's link to an engineer's computer, and the store its parameters are kept in.
//!
//! The firmware and the host tool are built with this same crate, so neither can mean something else
//! than the other. `docs/link.md` has the tables of the bytes.
//!
//! * [`frame`]: bytes on the line to checked frames and back;
//! * [`message`]: what a frame can say, with [`telemetry`] and [`report`] as the larger ones;
//! * [`leaves`]: every parameter by its [`key`], the [`law`] too; [`page`] lists them, [`parameters`]
//!   answers what is asked of them;
//! * [`store`]: the parameters in flash, as a [`record`];
//! * [`sender`]: what waits to go out, and what is dropped when too much does.
//!
//! Plain data in, plain data out: no allocation, no `unsafe`, no hardware. Any byte may come in at any
//! place; none makes the crate panic.
#![no_std]
#![forbid(unsafe_code)]

pub mod bytes;
pub mod frame;
pub mod key;
pub mod law;
pub mod leaves;
pub mod message;
pub mod page;
pub mod parameters;
pub mod record;
pub mod report;
pub mod sender;
pub mod store;
pub mod telemetry;
mod words;

pub use frame::{Decoder, Received};
pub use key::Key;
pub use message::Message;
pub use sender::Sender;
pub use store::Store;
