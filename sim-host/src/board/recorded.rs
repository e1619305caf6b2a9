//! What came over a line, kept as it came: written, and read again.

use super::line::{Line, LineError};
use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;
use std::time::Duration;

/// The raw bytes of a file, in its order and without waiting; its end is the line's.
pub struct Recording {
    name: String,
    file: File,
}

impl Recording {
    /// Opens a file that [`Recorder`] wrote, or any other bytes from a board.
    ///
    /// # Errors
    /// [`LineError::Open`].
    pub fn open(path: &Path) -> Result<Self, LineError> {
        let name = path.display().to_string();
        let file = File::open(path).map_err(|why| LineError::Open { line: name.clone(), why })?;
        Ok(Self { name, file })
    }
}

impl Line for Recording {
    fn send(&mut self, _: &[u8]) -> Result<(), LineError> {
        Err(LineError::OneWay { line: self.name.clone() })
    }

    fn receive(&mut self, _: Duration) -> Result<Vec<u8>, LineError> {
        let mut bytes = vec![0; 4096];
        let read = self.file.read(&mut bytes);
        let length = read.map_err(|why| LineError::Lost { line: self.name.clone(), why })?;
        if length == 0 {
            return Err(LineError::Ended { line: self.name.clone() });
        }
        bytes.truncate(length);
        Ok(bytes)
    }
}

/// A line of which everything that comes in is written to a file as well, at once.
pub struct Recorder {
    line: Box<dyn Line>,
    name: String,
    to: Box<dyn Write>,
}

impl Recorder {
    /// Writes what comes over `line` to `to`, which errors call `name`.
    pub fn new(line: Box<dyn Line>, name: &str, to: Box<dyn Write>) -> Self {
        Self { line, name: name.into(), to }
    }
}

impl Line for Recorder {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LineError> {
        self.line.send(bytes)
    }

    fn receive(&mut self, patience: Duration) -> Result<Vec<u8>, LineError> {
        let bytes = self.line.receive(patience)?;
        let written = self.to.write_all(&bytes).and_then(|()| self.to.flush());
        written.map_err(|why| LineError::Record { file: self.name.clone(), why })?;
        Ok(bytes)
    }

    fn reopen(&mut self) -> Option<Result<(), LineError>> {
        self.line.reopen()
    }
}
