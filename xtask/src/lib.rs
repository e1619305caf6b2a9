//! Builds the firmware images, runs them in QEMU and measures them; used by the `xtask` binary and by tests that run
//! QEMU.

pub mod against;
pub mod architecture;
pub mod bench;
pub mod cost;
pub mod counts;
pub mod coverage;
pub mod dbc;
pub mod document;
pub mod image;
pub mod instructions;
pub mod mutants;
pub mod paths;
pub mod peak;
pub mod probe;
pub mod process;
pub mod progress;
pub mod python;
pub mod qemu;
pub mod reproducible;
pub mod rides;
pub mod setup;
pub mod size;
pub mod virtual_board;

/// A result with an error text for the user of `cargo xtask`.
pub type Result<T> = std::result::Result<T, String>;
