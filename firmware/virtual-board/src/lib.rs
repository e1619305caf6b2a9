//! Virtual VESC 6 MK6: executes the flashed image, unchanged, at register level.
//!
//! The core (Cortex-M4F, NVIC, SysTick) and most peripherals are those of the crate `rigless`; [`chip`] replaces the
//! peripherals that the crate lacks or that need speed. [`parts`] models the devices beside the chip, [`power`] the
//! bridge and the motor, [`analog`] the analog inputs. [`Bench`] runs them step by step.
//!
//! Time is the number of instructions times an assumed number of clock cycles ([`Options::cycles_per_instruction`]);
//! it is not a measurement of the real chip.

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
