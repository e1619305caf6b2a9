//! The magnetic encoder AS5047P on its serial line: 14 bits to the turn.
//!
//! 16 bits, the highest first, clock low at rest, data taken at its falling edge. A word is answered in the next
//! transfer. Bit 15 makes the number of ones even, bit 14 of an answer tells that the last command was damaged.

/// Counts of one turn.
pub const COUNTS: u16 = 1 << 14;

/// The command that asks for the angle. All ones, so a line held high asks for it too and needs no wire.
pub const ASK_ANGLE: u16 = 0xffff;

/// The angle in an answer to [`ASK_ANGLE`] \[counts\]; `None` where it is damaged or an error is told. A cut line, pulled
/// up, reads as an error.
pub const fn angle_counts(answer: u16) -> Option<u16> {
    let even = answer.count_ones().is_multiple_of(2);
    let error = answer & 0x4000 != 0;
    if even && !error { Some(answer & 0x3fff) } else { None }
}
