//! Errors of a board in the loop.

use crate::ride::RemoteError;
use std::path::PathBuf;
use std::time::Duration;

/// Why a board cannot continue.
#[derive(Debug, thiserror::Error)]
pub enum BoardError {
    /// The emulator can't be started.
    #[error(
        "can't start qemu-system-arm: {0}; `cargo xtask setup` installs it, or apt-get install qemu-system-arm"
    )]
    NoQemu(std::io::Error),
    /// The image does not exist.
    #[error("there is no image {}; `cargo xtask firmware` builds it", .0.display())]
    NoImage(PathBuf),
    /// The emulator ended.
    #[error("the board {} ended ({status}) after {exchanges} exchanges{output}", .image.display())]
    Ended {
        /// The image.
        image: PathBuf,
        /// How the emulator ended.
        status: String,
        /// Exchanges until then.
        exchanges: u64,
        /// The end of its text output, on a new line.
        output: String,
    },
    /// The board did not answer in time.
    #[error("the board {} did not answer within {limit:?} after {exchanges} exchanges{output}", .image.display())]
    Silent {
        /// The image.
        image: PathBuf,
        /// The timeout.
        limit: Duration,
        /// Exchanges until then.
        exchanges: u64,
        /// The end of its text output, on a new line.
        output: String,
    },
    /// What the board sent is no chunk of the link.
    #[error(
        "the board's output is not in the format of docs/link.md: {0}; was the image built from this version?"
    )]
    NoChunk(String),
    /// More bytes for the board than a chunk holds.
    #[error("{0} bytes for the loop and {1} for the line are more than a chunk holds")]
    TooMuch(usize, usize),
    /// The board rejects the configuration.
    #[error("the board rejects the configuration: {0}")]
    Refused(String),
    /// The board broke the lockstep protocol.
    #[error("control step {step} since the reset: {what}")]
    Lockstep {
        /// The control step since the reset.
        step: u32,
        /// What happened.
        what: String,
    },
    /// The board supports one control rate only.
    #[error("rate_hz = {0}: an emulated board steps at 1000 Hz only")]
    Rate(f32),
}

impl From<BoardError> for RemoteError {
    fn from(error: BoardError) -> Self {
        Self(error.into())
    }
}
