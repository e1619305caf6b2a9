//! Processor in the loop: the data that host and emulated board exchange in every control period.
//!
//! The firmware runs in an emulator whose clock stops while it waits for the host, so that neither runs ahead. In each
//! period the board sends first, then it receives:
//!
//! | from the board | | to the board | |
//! | --- | --- | --- | --- |
//! | u32 | time since the emulator's start \[ms\], resets of the chip included | u16 | bytes of the loop |
//! | u16 | number of starts of the chip | u16 | bytes of the line |
//! | u16 | bytes of the loop | | the loop's bytes |
//! | u16 | bytes of the line | | the line's bytes |
//! | | the loop's bytes, the line's bytes | | |
//!
//! The *loop* carries the sensor frames and motor commands: [`crate::Message::PilFrame`] and
//! [`crate::Message::PilCommand`]. The *line* is the engineer's serial link, as on any board. Both can be damaged,
//! late or missing; the lengths and times of this table can't.

use crate::bytes::{Reader, Writer};

/// Largest exchange, header included \[bytes\]: small enough for one atomic write to a pipe.
pub const MAX_CHUNK: usize = 4096;
/// Time after which the motor gives no torque without a new command \[ms\].
pub const COMMAND_TIMEOUT_MS: u32 = 5;
/// Length of the board's header \[bytes\].
pub const BOARD_HEAD: usize = 10;
/// Length of the host's header \[bytes\].
pub const HOST_HEAD: usize = 4;

/// Data from the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FromBoard<'a> {
    /// Time since the emulator's start, resets of the chip included \[ms\].
    pub time_ms: u32,
    /// Number of starts of the chip, from 1.
    pub starts: u16,
    /// Bytes of the loop.
    pub motor: &'a [u8],
    /// Bytes of the engineer's line.
    pub line: &'a [u8],
}

/// Data from the host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ToBoard<'a> {
    /// Bytes of the loop.
    pub sensors: &'a [u8],
    /// Bytes of the engineer's line.
    pub line: &'a [u8],
}

impl<'a> FromBoard<'a> {
    /// Encodes the data and returns the length \[bytes\]; `None` if it does not fit.
    pub fn encode(&self, to: &mut [u8]) -> Option<usize> {
        let mut writer = Writer::new(to);
        writer.u32(self.time_ms);
        writer.u16(self.starts);
        put(&mut writer, self.motor, self.line)
    }

    /// Decodes the data; `None` if the length is wrong.
    pub fn decode(bytes: &'a [u8]) -> Option<Self> {
        let mut from = Reader(bytes);
        let (time_ms, starts) = (from.u32()?, from.u16()?);
        let (motor, line) = both(&mut from)?;
        Some(Self { time_ms, starts, motor, line })
    }
}

impl<'a> ToBoard<'a> {
    /// Encodes the data and returns the length \[bytes\]; `None` if it does not fit.
    pub fn encode(&self, to: &mut [u8]) -> Option<usize> {
        put(&mut Writer::new(to), self.sensors, self.line)
    }

    /// Decodes the data; `None` if the length is wrong.
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
