//! A two-way line of bytes to a board.

use std::io;
use std::time::Duration;

/// A two-way line of bytes to a board.
pub trait Transport {
    /// Sends all of `bytes`.
    ///
    /// # Errors
    /// The line is lost, or only goes the other way.
    fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError>;

    /// What came in since the last call, waiting up to `timeout` of real time for the first byte; empty when
    /// nothing came.
    ///
    /// # Errors
    /// The line is lost, or has come to its end.
    fn receive(&mut self, timeout: Duration) -> Result<Vec<u8>, TransportError>;

    /// Opens a lost line anew; `None` for one that never comes back.
    fn reopen(&mut self) -> Option<Result<(), TransportError>> {
        None
    }
}

/// Why nothing goes over a line. Each names the device or file.
///
/// None tells its cause as a source: a device that hangs up is a broken pipe to the system, and must not be taken for a
/// reader of standard output that goes away.
#[derive(Debug, thiserror::Error)]
pub enum TransportError {
    /// It can't be opened.
    #[error("can't open {line}: {why}")]
    Open {
        /// The device or file.
        line: String,
        /// Why not.
        why: io::Error,
    },
    /// It was there, and is no more.
    #[error("lost {line}: {why}")]
    Lost {
        /// The device or file.
        line: String,
        /// Why.
        why: io::Error,
    },
    /// A recording is at its end.
    #[error("{line} is at its end")]
    Ended {
        /// The file.
        line: String,
        /// Bytes at its end of a frame that is not whole.
        rest: usize,
    },
    /// A recording is no board: nothing can be asked of it.
    #[error("{line} is a recording; nothing can be sent to it")]
    OneWay {
        /// The file.
        line: String,
    },
    /// What came in can't be kept.
    #[error("can't write {file}: {why}")]
    Record {
        /// The file.
        file: String,
        /// Why not.
        why: io::Error,
    },
}
