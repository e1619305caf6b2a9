//! The steer assist on a chip: Embassy tasks around the `control` crate.
//!
//! [`tasks`] are the same on every board; [`board`] is the one that the features choose, a folder
//! each. The images are the files of `src/bin`. On the host there is nothing in this crate.
#![no_std]
#![cfg(target_os = "none")]

#[cfg(not(any(feature = "board-qemu", feature = "board-vesc6")))]
compile_error!("choose the board: --features board-qemu or --features board-vesc6");
#[cfg(all(feature = "board-qemu", feature = "board-vesc6"))]
compile_error!("choose one board only");

#[cfg(feature = "board-qemu")]
#[path = "board/qemu/mod.rs"]
pub mod board;
#[cfg(feature = "board-vesc6")]
#[path = "board/vesc6/mod.rs"]
pub mod board;

pub mod crash;
pub mod deadline;
pub mod failure;
pub mod heartbeat;
pub mod retained;
pub mod tasks;

/// Which image this is.
#[derive(Clone, Copy, Debug)]
pub struct Image {
    /// Its name.
    pub name: &'static str,
    /// The program's version.
    pub version: &'static str,
    /// The commit it is made from.
    pub commit: &'static str,
}

/// The [`Image`] that is being compiled.
#[macro_export]
macro_rules! image {
    () => {
        $crate::Image {
            name: env!("CARGO_BIN_NAME"),
            version: env!("CARGO_PKG_VERSION"),
            commit: env!("FIRMWARE_COMMIT").trim_ascii_end(),
        }
    };
}

/// Which image this is: its name, version and commit, one blank between them.
#[macro_export]
macro_rules! identity {
    () => {
        // Opaque, so that the words stay together in the image instead of in single instructions.
        core::hint::black_box(concat!(
            env!("CARGO_BIN_NAME"),
            " ",
            env!("CARGO_PKG_VERSION"),
            " ",
            env!("FIRMWARE_COMMIT")
        ))
    };
}
