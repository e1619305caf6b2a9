//! A virtual VESC 6 MK6: the image that is flashed, unchanged, executed at register level.
//!
//! The core (Cortex-M4F, NVIC, SysTick) and most of the chip's peripherals are those of the crate `rigless`; [`chip`]
//! replaces the peripherals that crate lacks or that the board exercises hardest. [`parts`] are the parts beside the
//! chip, [`power`] is the bridge with the motor behind it, [`analog`] what the converters measure. [`Bench`] runs all
//! of it step by step.
//!
//! Time is instructions at an assumed number of clock cycles each ([`Options::cycles_per_instruction`]); nothing here
//! measures a cycle of the real chip.

pub mod analog;
pub mod bench;
pub mod bicycle;
pub mod board;
mod cache;
pub mod chip;
mod core_state;
pub mod flash;
mod gap;
mod image;
pub mod inject;
pub mod load;
pub mod log;
#[path = "../../motor/tests/cards/machine.rs"]
#[allow(unreachable_pub, dead_code)]
mod machine;
pub mod parameters;
pub mod parts;
pub mod power;
pub mod pty;
pub mod serial;
pub mod wiring;

pub use bench::{Bench, Error};
pub use board::Options;
