//! Framing: encodes payloads as checked frames, and finds frames in a stream of bytes.
//!
//! A plain frame is version, kind, sequence number, payload and the CRC-32 of all of them. On the line it is encoded
//! with COBS (Cheshire and Baker 1999), so that the byte 0 occurs only between frames. Each frame has a 0 before and
//! after it, so that damage at its end does not affect the next frame.

use crate::bytes::{Reader, Writer};
use cobs::{DecodeResult, DecoderState};
use core::{mem, slice};
use crc::{CRC_32_ISO_HDLC, Crc};

/// Protocol version. In every version, the first byte of a frame is the version and the last four are the CRC.
pub const VERSION: u8 = 2;
/// Largest payload \[bytes\].
pub const MAX_PAYLOAD: usize = 320;
/// Length of version, kind and sequence number \[bytes\].
const HEAD: usize = 4;
/// Largest plain frame \[bytes\].
const MAX_PLAIN: usize = HEAD + MAX_PAYLOAD + 4;
/// Largest frame on the line \[bytes\].
pub const MAX_FRAME: usize = cobs::max_encoding_length(MAX_PLAIN) + 2;

/// CRC of frames, keys and configurations: CRC-32 as in Ethernet and zip.
pub const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// A received frame with a valid CRC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// Kind of the message; see [`crate::message`].
    pub kind: u8,
    /// Sequence number; an answer repeats that of its request.
    pub sequence: u16,
    /// Payload.
    pub payload: &'a [u8],
}

/// Result of decoding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Received<'a> {
    /// A frame of this version.
    Frame(Frame<'a>),
    /// A frame with a valid CRC, but of another version; its content is unknown.
    WrongVersion {
        /// Version of the frame.
        theirs: u8,
    },
}

/// Counters of dropped frames since the start, wrapping.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dropped {
    /// Not a frame: invalid COBS encoding, or too short.
    pub garbled: u32,
    /// Longer than the largest frame.
    pub too_long: u32,
    /// Wrong CRC.
    pub bad_crc: u32,
    /// Valid CRC, but another version.
    pub wrong_version: u32,
}

/// Encodes a frame into `to` and returns its length on the line \[bytes\]. `None` if it does not fit, or `payload` is
/// too long.
///
/// [`MAX_FRAME`] bytes always suffice.
pub fn encode(kind: u8, sequence: u16, payload: &[u8], to: &mut [u8]) -> Option<usize> {
    encode_with(kind, sequence, |w| w.put(payload), to)
}

/// As [`encode`], with a payload that is written by `fill`.
pub fn encode_with(
    kind: u8,
    sequence: u16,
    fill: impl FnOnce(&mut Writer<'_>),
    to: &mut [u8],
) -> Option<usize> {
    let mut plain = [0; MAX_PLAIN];
    let (body, _) = plain.split_at_mut_checked(HEAD + MAX_PAYLOAD)?;
    let mut writer = Writer::new(body);
    writer.u8(VERSION);
    writer.u8(kind);
    writer.u16(sequence);
    fill(&mut writer);
    let used = writer.used()?;
    let check = CRC.checksum(plain.get(..used)?);
    Writer::new(plain.get_mut(used..)?).u32(check);
    let plain = plain.get(..used + 4)?;
    let (before, to) = to.split_first_mut()?;
    if to.len() <= cobs::max_encoding_length(plain.len()) {
        return None;
    }
    let stuffed = cobs::try_encode(plain, to).ok()?;
    (*before, *to.get_mut(stuffed)?) = (0, 0);
    Some(stuffed + 2)
}

/// Finds frames in a stream of bytes.
#[derive(Debug)]
pub struct Decoder {
    stuffing: DecoderState,
    plain: [u8; MAX_PLAIN],
    /// Length of the frame so far \[bytes\]; more than [`MAX_PLAIN`] if it is too long.
    length: usize,
    dropped: Dropped,
}

impl Default for Decoder {
    fn default() -> Self {
        Self { stuffing: DecoderState::Idle, plain: [0; MAX_PLAIN], length: 0, dropped: Dropped::default() }
    }
}

impl Decoder {
    /// Counters of dropped frames.
    pub fn dropped(&self) -> Dropped {
        self.dropped
    }

    /// Consumes bytes from the front of `from`, up to the end of a frame or all of them; returns the completed frame,
    /// if any. Call repeatedly until `from` is empty.
    ///
    /// Accepts any byte. Bytes that form no frame are dropped and counted; decoding resumes after the next 0.
    pub fn take(&mut self, from: &mut &[u8]) -> Option<Received<'_>> {
        if self.fill(from) { self.complete() } else { None }
    }

    /// Consumes one byte; returns the frame that it completes, if any. See [`Decoder::take`].
    pub fn feed(&mut self, byte: u8) -> Option<Received<'_>> {
        self.take(&mut slice::from_ref(&byte))
    }

    /// Consumes bytes up to the end of a frame; returns whether a frame ended.
    fn fill(&mut self, from: &mut &[u8]) -> bool {
        // Local copies stay in registers during the loop.
        let (mut stuffing, mut length) = (mem::take(&mut self.stuffing), self.length);
        let mut bytes = from.iter();
        let complete = bytes.by_ref().any(|byte| {
            match stuffing.feed(*byte) {
                Ok(DecodeResult::NoData) => {}
                Ok(DecodeResult::DataStart) => length = 0,
                Ok(DecodeResult::DataContinue(byte)) => {
                    if let Some(place) = self.plain.get_mut(length) {
                        *place = byte;
                        length += 1;
                    } else {
                        length = MAX_PLAIN + 1;
                    }
                }
                Ok(DecodeResult::DataComplete) => return true,
                Err(_) if length > MAX_PLAIN => count(&mut self.dropped.too_long),
                Err(_) => count(&mut self.dropped.garbled),
            }
            false
        });
        *from = bytes.as_slice();
        (self.stuffing, self.length) = (stuffing, length);
        complete
    }

    fn complete(&mut self) -> Option<Received<'_>> {
        let Some(plain) = self.plain.get(..self.length) else {
            count(&mut self.dropped.too_long);
            return None;
        };
        let Some((body, check)) = plain.split_last_chunk::<4>().filter(|(body, _)| body.len() >= HEAD) else {
            count(&mut self.dropped.garbled);
            return None;
        };
        if CRC.checksum(body) != u32::from_le_bytes(*check) {
            count(&mut self.dropped.bad_crc);
            return None;
        }
        let mut from = Reader(body);
        let (theirs, kind, sequence) = (from.u8()?, from.u8()?, from.u16()?);
        if theirs != VERSION {
            count(&mut self.dropped.wrong_version);
            return Some(Received::WrongVersion { theirs });
        }
        Some(Received::Frame(Frame { kind, sequence, payload: from.0 }))
    }
}

fn count(dropped: &mut u32) {
    *dropped = dropped.wrapping_add(1);
}
