//! Magnetic encoder AS5047P, SPI protocol: 14 bits per turn.
//!
//! 16-bit words, most significant bit first, clock idle low, data sampled on its falling edge. The answer to a word
//! comes in the next transfer. Bit 15 is even parity; bit 14 of an answer is the error flag EF: a damaged command.

/// Counts per turn.
pub const COUNTS: u16 = 1 << 14;

/// Command that reads the angle. All ones, so that a constantly high line works without a wire.
pub const READ_ANGLE: u16 = 0xffff;

/// Number of consecutive answers that EF invalidates; further ones are only counted. Less than the timeout after
/// which the motor loop raises an encoder loss.
pub const FLAGGED: u8 = 5;

/// State of the SPI line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Line {
    flagged_in_row: u8,
    /// Number of answers with the error flag, wrapping.
    pub flagged: u32,
    /// Number of damaged answers, wrapping.
    pub damaged: u32,
}

impl Line {
    /// Decodes the angle from an answer to [`READ_ANGLE`] \[counts\]; `None` if the answer is damaged, or flagged for
    /// the first [`FLAGGED`] times in a row.
    ///
    /// The flag concerns a command frame, not the angle in the same answer. As the command is all ones, only a wrong
    /// number of clocks can damage it: a frame cut by a reset, or an extra edge. The register that clears the flag
    /// can't be read without a wire to the encoder, and the related AS5050 keeps the flag until then (its data sheet,
    /// "Clear error flag command"). A permanent flag must not mean an encoder loss until power-off. The VESC firmware
    /// ignores the flag in this wiring (`encoder/enc_as504x.c` in vedderb/bldc). Parity and the motor loop's jump
    /// check remain. An open line with pull-up reads as all ones, which is never a valid angle.
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
