//! Processor in the loop: what host and board hand each other once every control period.
//!
//! The board's program runs in an emulator whose clock stands still while it waits for the host, so that
//! neither is ever ahead. In each period the board hands over first, then it takes:
//!
//! | from the board | | to the board | |
//! | --- | --- | --- | --- |
//! | u32 | time since the emulator's start \[ms\], resets of the chip included | u16 | bytes of the loop |
//! | u16 | how often the chip started | u16 | bytes of the line |
//! | u16 | bytes of the loop | | the loop's bytes |
//! | u16 | bytes of the line | | the line's bytes |
//! | | the loop's bytes, the line's bytes | | |
//!
//! The *loop* stands for sensors and motor: frames of [`crate::Message::PilFrame`] and
//! [`crate::Message::PilCommand`]. The *line* is the engineer's, as on any board. Both are bytes that may
//! be damaged, late or missing; what is in this table is not.

use crate::bytes::{Reader, Writer};

/// Most bytes handed over at once, head included: a pipe takes them in one piece.
pub const MAX_CHUNK: usize = 4096;
/// Longest that a motor goes on with a command: without a newer one it gives no torque \[ms\].
pub const COMMAND_TIMEOUT_MS: u32 = 5;
/// Bytes before those of loop and line, from the board.
pub const BOARD_HEAD: usize = 10;
/// Bytes before those of loop and line, to the board.
pub const HOST_HEAD: usize = 4;

/// What the board hands over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FromBoard<'a> {
    /// Time since the emulator's start, whatever was reset since \[ms\].
    pub time_ms: u32,
    /// How often the chip started, 1 at first.
    pub starts: u16,
    /// Bytes of the loop.
    pub motor: &'a [u8],
    /// Bytes of the engineer's line.
    pub line: &'a [u8],
}

/// What the host hands over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ToBoard<'a> {
    /// Bytes of the loop.
    pub sensors: &'a [u8],
    /// Bytes of the engineer's line.
    pub line: &'a [u8],
}

impl<'a> FromBoard<'a> {
    /// Writes it; how many bytes it takes, `None` if there is no room.
    pub fn encode(&self, to: &mut [u8]) -> Option<usize> {
        let mut writer = Writer::new(to);
        writer.u32(self.time_ms);
        writer.u16(self.starts);
        put(&mut writer, self.motor, self.line)
    }

    /// Reads it; `None` if these are not just its bytes.
    pub fn decode(bytes: &'a [u8]) -> Option<Self> {
        let mut from = Reader(bytes);
        let (time_ms, starts) = (from.u32()?, from.u16()?);
        let (motor, line) = both(&mut from)?;
        Some(Self { time_ms, starts, motor, line })
    }
}

impl<'a> ToBoard<'a> {
    /// Writes it; how many bytes it takes, `None` if there is no room.
    pub fn encode(&self, to: &mut [u8]) -> Option<usize> {
        put(&mut Writer::new(to), self.sensors, self.line)
    }

    /// Reads it; `None` if these are not just its bytes.
    pub fn decode(bytes: &'a [u8]) -> Option<Self> {
        let (sensors, line) = both(&mut Reader(bytes))?;
        Some(Self { sensors, line })
    }
}

fn put(writer: &mut Writer<'_>, in_loop: &[u8], line: &[u8]) -> Option<usize> {
    writer.u16(u16::try_from(in_loop.len()).ok()?);
    writer.u16(u16::try_from(line.len()).ok()?);
    writer.put(in_loop);
    writer.put(line);
    writer.used()
}

fn both<'a>(from: &mut Reader<'a>) -> Option<(&'a [u8], &'a [u8])> {
    let (first, second) = (usize::from(from.u16()?), usize::from(from.u16()?));
    let (in_loop, line) = from.0.split_at_checked(first)?;
    (line.len() == second).then_some((in_loop, line))
}
