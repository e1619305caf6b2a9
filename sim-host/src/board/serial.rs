//! A serial port as the line to a board.

use super::transport::{Transport, TransportError};
use serialport::{ClearBuffer, SerialPort};
use std::io::{self, ErrorKind, Read, Write};
use std::time::Duration;

/// Longest time to send a frame; at 9600 baud the largest takes 0.35 s.
const SENDING: Duration = Duration::from_secs(2);

/// A serial port, 8 data bits, no parity, one stop bit.
pub struct Serial {
    name: String,
    baud: u32,
    port: Box<dyn SerialPort>,
}

impl Serial {
    /// Opens `name` and discards the bytes already waiting. Where the baud rate has no meaning (USB), any value works.
    ///
    /// # Errors
    /// [`TransportError::Open`].
    pub fn open(name: &str, baud: u32) -> Result<Self, TransportError> {
        let opened = serialport::new(name, baud).timeout(SENDING).open();
        let port = opened.and_then(|port| port.clear(ClearBuffer::Input).map(|()| port));
        let failed = |error: serialport::Error| TransportError::Open {
            line: name.into(),
            error: io::Error::other(error),
        };
        Ok(Self { name: name.into(), baud, port: port.map_err(failed)? })
    }

    fn lost(&self, error: io::Error) -> TransportError {
        TransportError::Lost { line: self.name.clone(), error }
    }
}

impl Transport for Serial {
    fn send(&mut self, bytes: &[u8]) -> Result<(), TransportError> {
        let sent = self.port.set_timeout(SENDING).map_err(io::Error::from);
        sent.and_then(|()| self.port.write_all(bytes)).map_err(|error| self.lost(error))
    }

    fn receive(&mut self, timeout: Duration) -> Result<Vec<u8>, TransportError> {
        let mut bytes = vec![0; 4096];
        let ready = self.port.set_timeout(timeout).map_err(io::Error::from);
        match ready.and_then(|()| self.port.read(&mut bytes)) {
            Ok(0) => Err(self.lost(ErrorKind::UnexpectedEof.into())),
            Ok(length) => {
                bytes.truncate(length);
                Ok(bytes)
            }
            Err(error) if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::Interrupted) => {
                Ok(Vec::new())
            }
            Err(error) => Err(self.lost(error)),
        }
    }

    fn reopen(&mut self) -> Option<Result<(), TransportError>> {
        Some(Self::open(&self.name, self.baud).map(|anew| *self = anew))
    }
}
