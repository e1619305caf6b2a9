//! Builds the firmware images, runs them in QEMU, measures them. The `xtask` binary and the tests
//! that drive QEMU both stand on this.

pub mod bench;
pub mod coverage;
pub mod document;
pub mod image;
pub mod instructions;
pub mod mutants;
pub mod process;
pub mod progress;
pub mod qemu;
pub mod reproducible;
pub mod rides;
pub mod setup;
pub mod size;
pub mod virtual_board;

/// A failure in words for whoever called `cargo xtask`.
pub type Result<T> = std::result::Result<T, String>;
