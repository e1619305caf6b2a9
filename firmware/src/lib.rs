//! Firmware of the steer assist: Embassy tasks around the `control` crate.
//!
//! [`tasks`] are the same on every board; [`board`] is selected by a feature, one folder per board. The files of
//! `src/bin` are the images. On the host this crate is empty.
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
pub mod telemetry;

/// Identity of an image.
#[derive(Clone, Copy, Debug)]
pub struct Image {
    /// Name of the image.
    pub name: &'static str,
    /// Version of the firmware.
    pub version: &'static str,
    /// Commit it was built from.
    pub commit: &'static str,
}

/// The [`Image`] of this build.
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

/// Name, version and commit of this image, separated by spaces.
#[macro_export]
macro_rules! identity {
    () => {
        // `black_box` keeps the text contiguous in the image instead of split into instructions.
        core::hint::black_box(concat!(
            env!("CARGO_BIN_NAME"),
            " ",
            env!("CARGO_PKG_VERSION"),
            " ",
            env!("FIRMWARE_COMMIT")
        ))
    };
}
