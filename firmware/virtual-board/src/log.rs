//! The board's log: bytes of its RTT buffer, decoded by defmt's decoder.

use defmt_decoder::{DecodeError, StreamDecoder, Table};
use rigless::emulator::Host;
use rigless::soc::Width;

/// A log line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// Time of the fetch, at most a millisecond after it was written \[us\].
    pub at_us: u64,
    /// Level, in capitals.
    pub level: String,
    /// Text.
    pub text: String,
}

/// The log so far.
pub struct Log {
    decoder: Box<dyn StreamDecoder + Send>,
    lines: Vec<Line>,
}

impl Log {
    /// Reads the table of the image in these bytes.
    ///
    /// # Errors
    /// An image without a defmt table.
    pub(crate) fn new(image: &[u8]) -> Result<Self, String> {
        let table = Table::parse(image).map_err(|e| e.to_string())?.ok_or("no defmt table in it")?;
        // Leaked, as the decoder borrows the table; one per board.
        let table: &'static Table = Box::leak(Box::new(table));
        Ok(Self { decoder: table.new_stream_decoder(), lines: Vec::new() })
    }

    pub(crate) fn push(&mut self, bytes: &[u8], at_ms: f64) {
        self.decoder.received(bytes);
        loop {
            match self.decoder.decode() {
                Ok(frame) => self.lines.push(Line {
                    at_us: (at_ms * 1e3) as u64,
                    level: frame.level().map_or_else(String::new, |level| level.as_str().to_uppercase()),
                    text: frame.display_message().to_string(),
                }),
                Err(DecodeError::UnexpectedEof) => break,
                Err(DecodeError::Malformed) => (),
            }
        }
    }

    pub(crate) fn lines(&self) -> &[Line] {
        &self.lines
    }
}

/// Address of the RTT control block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rtt(u32);

impl Rtt {
    pub(crate) fn find(image: &[u8]) -> Result<Self, String> {
        let symbols = rigless::symbols::Symbols::read(image, |address| address).map_err(|e| e.to_string())?;
        symbols.get("_SEGGER_RTT").map(|at| Self(at as u32)).map_err(|e| e.to_string())
    }

    /// Reads and empties the first up channel. Layout: SEGGER's RTT control block, 24 bytes before the first
    /// channel's name, buffer, size, write and read offset.
    pub(crate) fn drain(self, host: &mut dyn Host) -> Vec<u8> {
        let word =
            |host: &mut dyn Host, at: u32| host.read(u64::from(at), Width::W32).map_or(0, |word| word as u32);
        let [buffer, size, write, read] = [28, 32, 36, 40].map(|offset| word(host, self.0 + offset));
        if buffer < 0x2000_0000 || size == 0 || size > 0x1_0000 || write >= size || read >= size {
            return Vec::new();
        }
        let mut bytes = Vec::new();
        let mut at = read;
        while at != write {
            bytes.push(host.read(u64::from(buffer + at), Width::W8).map_or(0, |byte| byte as u8));
            at = (at + 1) % size;
        }
        if at != read {
            // This memory was just read.
            let _ = host.write(u64::from(self.0 + 40), Width::W32, u64::from(at));
        }
        bytes
    }
}
