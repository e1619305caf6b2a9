//! The board's link to an engineer's computer, and the store its parameters are kept in.
//!
//! The firmware and the host tool are built with this same crate, so neither can mean something else
//! than the other. `docs/link.md` has the tables of the bytes.
//!
//! * [`frame`]: bytes on the line to checked frames and back;
//! * [`message`]: what a frame can say, with [`telemetry`] and [`report`] as the larger ones;
//! * [`leaves`]: every parameter by its [`key`], the [`law`] too; [`page`] lists them, [`parameters`]
//!   answers what is asked of them, or with a [`rejection`];
//! * [`store`]: the parameters in flash, as a [`record`], and the encoder's offset, as an [`alignment`];
//! * [`ring`]: the last faults, in memory that keeps them through a reset;
//! * [`sender`]: what waits to go out, and what is dropped when too much does;
//! * [`lockstep`]: what goes over in a control period when the board is emulated.
//!
//! A board takes each byte that comes in, and sends each that goes out:
//!
//! ```
//! use link::{Decoder, Message, Received, Sender, page::PAGE_BYTES, requests};
//!
//! fn take(byte: u8, decoder: &mut Decoder, config: &mut control::Config, engaged: bool, sender: &mut Sender<1024, 1024>) {
//!     let Some(received) = decoder.feed(byte) else { return };
//!     let mut room = [0; PAGE_BYTES];
//!     match requests::request(&received) {
//!         Ok((sequence, request)) => {
//!             let defaults = control::Config::product();
//!             if let Some(answer) = requests::answer(&defaults, config, engaged, &request, &mut room) {
//!                 sender.answer(&answer, sequence);
//!             }
//!         }
//!         Err(wrong) => {
//!             let (sequence, answer) = wrong.answer();
//!             sender.answer(&answer, sequence);
//!         }
//!     }
//! }
//!
//! let (mut line, mut config, mut sender) = ([0; 64], control::Config::product(), Sender::new(20));
//! let (mut board, mut host) = (Decoder::default(), Decoder::default());
//! let used = Message::Get { key: link::Key::whole("rate_hz") }.encode(7, &mut line).unwrap();
//! line[..used].iter().for_each(|byte| take(*byte, &mut board, &mut config, true, &mut sender));
//! let mut answers = 0;
//! while let Some(byte) = sender.next_byte() {
//!     if let Some(Received::Frame(frame)) = host.feed(byte) {
//!         let answer = Message::Value { key: link::Key::whole("rate_hz"), value: Some(1000.0) };
//!         assert_eq!((frame.sequence, Message::decode(&frame)), (7, Ok(answer)));
//!         answers += 1;
//!     }
//! }
//! assert_eq!(answers, 1);
//! ```
//!
//! Plain data in, plain data out: no allocation, no `unsafe`, no hardware. Any byte may come in at any
//! place; none makes the crate panic.
#![no_std]
#![forbid(unsafe_code)]

pub mod alignment;
pub mod bytes;
pub mod can;
pub mod can_bit_timing;
pub mod can_mailbox;
pub mod fault_log;
pub mod frame;
pub mod key;
pub mod law;
pub mod lockstep;
pub mod message;
pub mod page;
pub mod parameter_list;
pub mod record;
pub mod rejection;
pub mod report;
pub mod requests;
pub mod store;
pub mod telemetry;
pub mod tx_queue;
mod word_flash;

pub use frame::{Decoder, Received};
pub use key::Key;
pub use message::Message;
pub use store::Store;
pub use tx_queue::TxQueue;
