//! Frames: what is said, made safe to find and to trust in a stream of bytes.
//!
//! Plain, a frame is version, kind, sequence number, payload and the CRC-32 of all of them. On the line
//! it is stuffed (COBS, Cheshire and Baker 1999), so that the byte 0 stands only between frames: one
//! before and one after each, so that damage to the end of one can't take the next one with it.

use crate::bytes::{Reader, Writer};
use cobs::{DecodeResult, DecoderState};
use core::{mem, slice};
use crc::{CRC_32_ISO_HDLC, Crc};

/// The version spoken here. A frame's first byte, and the CRC its last four, in every version there will be.
pub const VERSION: u8 = 1;
/// Most bytes that a frame may say.
pub const MAX_PAYLOAD: usize = 320;
/// Version, kind and sequence number.
const HEAD: usize = 4;
/// Most bytes of a frame that is not stuffed.
const MAX_PLAIN: usize = HEAD + MAX_PAYLOAD + 4;
/// Most bytes of a frame on the line.
pub const MAX_FRAME: usize = cobs::max_encoding_length(MAX_PLAIN) + 2;

/// The check of frames, keys and configurations: CRC-32 as in Ethernet and zip.
pub const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// A frame that was received whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// What kind of message it is; see [`crate::message`].
    pub kind: u8,
    /// Its number; an answer has that of what it answers.
    pub sequence: u16,
    /// What it says.
    pub payload: &'a [u8],
}

/// What came in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Received<'a> {
    /// A frame of this version.
    Frame(Frame<'a>),
    /// A frame that is whole, but of another version: what it says is not known.
    WrongVersion {
        /// The version it is of.
        theirs: u8,
    },
}

/// What was received and dropped, each since the start, wrapping.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dropped {
    /// No frame at all: wrongly stuffed, or too short.
    pub garbled: u32,
    /// Longer than any frame.
    pub too_long: u32,
    /// Not what was sent: its CRC is another.
    pub bad_crc: u32,
    /// Whole, but of another version.
    pub wrong_version: u32,
}

/// Puts a frame on the line into `to`; how many bytes it takes. `None`: no room, or `payload` is too long.
///
/// [`MAX_FRAME`] bytes are always room enough.
pub fn encode(kind: u8, sequence: u16, payload: &[u8], to: &mut [u8]) -> Option<usize> {
    encode_with(kind, sequence, |w| w.put(payload), to)
}

/// As [`encode`], of a payload that is written by `fill`.
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
    /// Bytes of the frame so far; more than [`MAX_PLAIN`] if it is too long.
    length: usize,
    dropped: Dropped,
}

impl Default for Decoder {
    fn default() -> Self {
        Self { stuffing: DecoderState::Idle, plain: [0; MAX_PLAIN], length: 0, dropped: Dropped::default() }
    }
}

impl Decoder {
    /// What was dropped so far.
    pub fn dropped(&self) -> Dropped {
        self.dropped
    }

    /// Takes bytes from the front of `from`, all of them or up to where one may have ended a frame; what they
    /// completed, if they did. To be called as long as there are any.
    ///
    /// Any byte may come. What is no frame is dropped and counted; the frame after the next 0 is found again.
    pub fn take(&mut self, from: &mut &[u8]) -> Option<Received<'_>> {
        if self.fill(from) { self.complete() } else { None }
    }

    /// Takes the next byte; what it completes, if it does. As [`Decoder::take`].
    pub fn feed(&mut self, byte: u8) -> Option<Received<'_>> {
        self.take(&mut slice::from_ref(&byte))
    }

    /// Takes bytes, up to the end of a frame if one ends; whether it does.
    fn fill(&mut self, from: &mut &[u8]) -> bool {
        // In registers while the bytes pass.
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
