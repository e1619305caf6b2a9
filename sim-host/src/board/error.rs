//! What can go wrong with a board in the loop.

use crate::ride::RemoteError;
use std::path::PathBuf;
use std::time::Duration;

/// Why a board can't be gone on with.
#[derive(Debug, thiserror::Error)]
pub enum BoardError {
    /// The emulator can't be started.
    #[error(
        "can't start qemu-system-arm: {0}; `cargo xtask setup` installs it, or apt-get install qemu-system-arm"
    )]
    NoQemu(std::io::Error),
    /// There is no such image.
    #[error("there is no image {}; `cargo xtask firmware` builds it", .0.display())]
    NoImage(PathBuf),
    /// The emulator ended.
    #[error("the board {} ended ({status}) after {exchanges} exchanges{said}", .image.display())]
    Ended {
        /// The image.
        image: PathBuf,
        /// How the emulator ended.
        status: String,
        /// Exchanges until then.
        exchanges: u64,
        /// What it wrote for people, behind a line of its own.
        said: String,
    },
    /// It did not answer in time.
    #[error("the board {} did not answer within {limit:?} after {exchanges} exchanges{said}", .image.display())]
    Silent {
        /// The image.
        image: PathBuf,
        /// How long it was waited for.
        limit: Duration,
        /// Exchanges until then.
        exchanges: u64,
        /// What it wrote for people, behind a line of its own.
        said: String,
    },
    /// What it handed over is none of the link's chunks.
    #[error("the board hands over what is no chunk of docs/link.md: {0}; is the image of this version?")]
    NoChunk(String),
    /// More for the board than a chunk holds.
    #[error("{0} bytes for the loop and {1} for the line are more than a chunk holds")]
    TooMuch(usize, usize),
    /// It does not take the configuration.
    #[error("the board refuses the configuration: {0}")]
    Refused(String),
    /// It did not do what the lockstep promises.
    #[error("control step {step} since the reset: {what}")]
    Astray {
        /// The control step since the reset.
        step: u32,
        /// What happened.
        what: String,
    },
    /// It steps at one rate only.
    #[error("rate_hz = {0}: an emulated board steps at 1000 Hz only")]
    Rate(f32),
}

impl From<BoardError> for RemoteError {
    fn from(error: BoardError) -> Self {
        Self(error.to_string())
    }
}
