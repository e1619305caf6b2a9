//! The magnetic encoder AS5047P on its serial line: 14 bits to the turn.
//!
//! 16 bits, the highest first, clock low at rest, data taken at its falling edge. A word is answered in the next
//! transfer. Bit 15 makes the number of ones even, bit 14 of an answer is the error flag EF: a command was damaged.

/// Counts of one turn.
pub const COUNTS: u16 = 1 << 14;

/// The command that asks for the angle. All ones, so a line held high asks for it too and needs no wire.
pub const ASK_ANGLE: u16 = 0xffff;

/// Answers in a row that EF refuses; from then on it is only counted. Below the age at which the motor's loop calls the
/// encoder lost.
pub const FLAGGED: u8 = 5;

/// What is remembered of the line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Line {
    flagged_in_row: u8,
    /// Answers with the error flag. Wrapping.
    pub flagged: u32,
    /// Damaged answers. Wrapping.
    pub damaged: u32,
}

impl Line {
    /// The angle in an answer to [`ASK_ANGLE`] \[counts\]; `None` where it is damaged, or flagged for the first
    /// [`FLAGGED`] times in a row.
    ///
    /// The flag is about a command frame, not about the angle beside it. Its command being all ones, the only damage is
    /// a wrong number of clocks: a frame cut by a reset, an edge too many. The register that would clear the flag can't
    /// be read without a wire to the encoder, and the sister AS5050 keeps it until then (its data sheet, "Clear error
    /// flag command"); a flag for good must not be an encoder lost until power is cut. The drive's own firmware ignores
    /// it in this wiring (`encoder/enc_as504x.c` in vedderb/bldc). Parity and the motor's own check of jumps remain. A
    /// cut line, pulled up, reads as all ones: that is no angle ever.
    pub const fn step(&mut self, answer: u16) -> Option<u16> {
        let even = answer.count_ones().is_multiple_of(2);
        if !even || answer == 0xffff {
            self.damaged = self.damaged.wrapping_add(1);
            return None;
        }
        if answer & 0x4000 == 0 {
            self.flagged_in_row = 0;
            return Some(answer & 0x3fff);
        }
        self.flagged = self.flagged.wrapping_add(1);
        if self.flagged_in_row < FLAGGED {
            self.flagged_in_row += 1;
            return None;
        }
        Some(answer & 0x3fff)
    }
}
