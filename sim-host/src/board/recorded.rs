//! Recordings of the raw bytes received over a line: writing and reading.

use super::transport::{Transport, TransportError};
use link::frame::MAX_FRAME;
use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;
use std::time::Duration;

/// The raw bytes of a file from its first whole frame on, in order and without waiting; its end is the end of the line.
pub struct Recording {
    name: String,
    file: File,
    /// Whether the 0 before the first whole frame has been read.
    started: bool,
    /// Bytes after the last 0.
    rest: usize,
}

impl Recording {
    /// Opens a file that [`Recorder`] wrote, or any other bytes from a board.
    ///
    /// # Errors
    /// [`TransportError::Open`].
    pub fn open(path: &Path) -> Result<Self, TransportError> {
        let name = path.display().to_string();
        let file = File::open(path).map_err(|error| TransportError::Open { line: name.clone(), error })?;
        Ok(Self { name, file, started: false, rest: 0 })
    }
}

impl Transport for Recording {
    fn send(&mut self, _: &[u8]) -> Result<(), TransportError> {
        Err(TransportError::OneWay { line: self.name.clone() })
    }

    fn receive(&mut self, _: Duration) -> Result<Vec<u8>, TransportError> {
        let mut bytes = vec![0; 4096];
        let read = self.file.read(&mut bytes);
        let length = read.map_err(|error| TransportError::Lost { line: self.name.clone(), error })?;
        if length == 0 {
            return Err(TransportError::Ended { line: self.name.clone(), rest: self.rest });
        }
        bytes.truncate(length);
        let first = bytes.iter().position(|byte| *byte == 0);
        match first {
            // Reception begins in the middle of a frame.
            Some(first) if !self.started => drop(bytes.drain(..first)),
            None if !self.started => bytes.clear(),
            _ => {}
        }
        self.started |= first.is_some();
        self.rest = match bytes.iter().rposition(|byte| *byte == 0) {
            Some(last) => bytes.len() - 1 - last,
            None => self.rest + bytes.len(),
        };
        Ok(bytes)
    }
}

/// A line whose received bytes are also written to a file as soon as a frame ends: a recording that ends within a frame
/// was cut.
pub struct Recorder {
    line: Box<dyn Transport>,
    name: String,
    to: Box<dyn Write>,
    /// Bytes received since the last end of a frame.
    pending: Vec<u8>,
}

impl Recorder {
    /// Writes the bytes received over `line` to `to`; `name` is its name in errors.
    pub fn new(line: Box<dyn Transport>, name: &str, to: Box<dyn Write>) -> Self {
        Self { line, name: name.into(), to, pending: Vec::new() }
    }
}

impl Transport for Recorder {
    fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError> {
        self.line.send(bytes)
    }

    fn receive(&mut self, timeout: Duration) -> Result<Vec<u8>, TransportError> {
        let bytes = self.line.receive(timeout)?;
        self.pending.extend(&bytes);
        // Bytes longer than a frame are noise and are written as received.
        let whole = match self.pending.iter().rposition(|byte| *byte == 0) {
            Some(last) => last + 1,
            None if self.pending.len() > MAX_FRAME => self.pending.len(),
            None => 0,
        };
        let written = self.to.write_all(&self.pending[..whole]).and_then(|()| self.to.flush());
        written.map_err(|error| TransportError::Record { file: self.name.clone(), error })?;
        self.pending.drain(..whole);
        Ok(bytes)
    }

    fn reopen(&mut self) -> Option<Result<(), TransportError>> {
        self.line.reopen()
    }
}
