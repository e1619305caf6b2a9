//! A two-way line of bytes to a board.

use std::io;
use std::time::Duration;

/// A two-way line of bytes to a board.
pub trait Transport {
    /// Sends all of `bytes`.
    ///
    /// # Errors
    /// The line is lost, or only receives.
    fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError>;

    /// Bytes received since the last call; waits up to `timeout` of real time for the first one; empty on timeout.
    ///
    /// # Errors
    /// The line is lost, or has ended.
    fn receive(&mut self, timeout: Duration) -> Result<Vec<u8>, TransportError>;

    /// Reopens a lost line; `None` for a line that cannot be reopened.
    fn reopen(&mut self) -> Option<Result<(), TransportError>> {
        None
    }
}

/// Why a line failed. Each error names the device or file.
///
/// None has an error source: a device that hangs up is a broken pipe to the system, and must not be mistaken for a
/// closed standard output.
#[derive(Debug, thiserror::Error)]
pub enum TransportError {
    /// It can't be opened.
    #[error("can't open {line}: {error}")]
    Open {
        /// The device or file.
        line: String,
        /// The system's error.
        error: io::Error,
    },
    /// The line was open and is lost.
    #[error("lost {line}: {error}")]
    Lost {
        /// The device or file.
        line: String,
        /// The system's error.
        error: io::Error,
    },
    /// A recording is at its end.
    #[error("{line} is at its end")]
    Ended {
        /// The file.
        line: String,
        /// Bytes of an incomplete frame at its end.
        rest: usize,
    },
    /// A recording cannot receive requests.
    #[error("{line} is a recording; nothing can be sent to it")]
    OneWay {
        /// The file.
        line: String,
    },
    /// The received bytes cannot be recorded.
    #[error("can't write {file}: {error}")]
    Record {
        /// The file.
        file: String,
        /// The system's error.
        error: io::Error,
    },
}
