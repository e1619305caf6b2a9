//! The board's serial link to the host, its CAN broadcasts, and its parameter store in flash.
//!
//! Firmware and host tool share this crate, so that both use the same encoding. `docs/link.md` has the tables of the
//! bytes.
//!
//! * [`frame`]: bytes on the line to checked frames and back;
//! * [`message`]: the messages, with [`telemetry`] and [`report`] as the larger ones;
//! * [`parameter_list`]: every parameter by its [`key`], the [`law`] included; [`page`] lists them, [`requests`]
//!   answers requests about them, or with a [`rejection`];
//! * [`store`]: the parameters in flash, as a [`record`], and the encoder's offset, as an [`alignment`];
//! * [`fault_log`]: the last faults, in memory that survives a reset;
//! * [`tx_queue`]: frames to be sent, and which are dropped if there are too many;
//! * [`can`]: the frames on CAN, with [`can_bit_timing`] and [`can_mailbox`] for the chip's controller;
//! * [`lockstep`]: data exchanged in each control period when the board is emulated.
//!
//! A board decodes each received byte and sends each queued byte:
//!
//! ```
//! use link::{Decoder, Message, Received, TxQueue, page::PAGE_BYTES, requests};
//!
//! fn take(byte: u8, decoder: &mut Decoder, config: &mut control::Config, engaged: bool, queue: &mut TxQueue<1024, 1024>) {
//!     let Some(received) = decoder.feed(byte) else { return };
//!     let mut room = [0; PAGE_BYTES];
//!     match requests::request(&received) {
//!         Ok((sequence, request)) => {
//!             let defaults = control::Config::product();
//!             if let Some(answer) = requests::answer(&defaults, config, engaged, &request, &mut room) {
//!                 queue.answer(&answer, sequence);
//!             }
//!         }
//!         Err(wrong) => {
//!             let (sequence, answer) = wrong.answer();
//!             queue.answer(&answer, sequence);
//!         }
//!     }
//! }
//!
//! let (mut line, mut config, mut queue) = ([0; 64], control::Config::product(), TxQueue::new(20));
//! let (mut board, mut host) = (Decoder::default(), Decoder::default());
//! let used = Message::Get { key: link::Key::whole("rate_hz") }.encode(7, &mut line).unwrap();
//! line[..used].iter().for_each(|byte| take(*byte, &mut board, &mut config, true, &mut queue));
//! let mut answers = 0;
//! while let Some(byte) = queue.next_byte() {
//!     if let Some(Received::Frame(frame)) = host.feed(byte) {
//!         let answer = Message::Value { key: link::Key::whole("rate_hz"), value: Some(1000.0) };
//!         assert_eq!((frame.sequence, Message::decode(&frame)), (7, Ok(answer)));
//!         answers += 1;
//!     }
//! }
//! assert_eq!(answers, 1);
//! ```
//!
//! Plain data in, plain data out: no allocation, no `unsafe`, no hardware. No received byte makes the crate panic.
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
