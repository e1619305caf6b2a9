//! Model of the magnetic encoder AS5047P without a data line to it: every word reads the angle.

use super::shift::{Event, Lines, Take};

/// The encoder.
#[derive(Clone, Debug)]
pub struct As5047 {
    lines: Lines,
    bits: u32,
    answer: u16,
    shifting: u16,
    /// Whether it is disconnected: the pull resistor determines the line.
    pub cut: bool,
    /// Stuck angle, independent of the shaft \[counts\].
    pub frozen: Option<u16>,
    /// Whether the error flag is set in every answer.
    pub error_flag: bool,
    /// Remaining number of answers damaged by a flipped bit.
    pub glitches: u32,
}

impl As5047 {
    /// State after power-on.
    pub const fn new() -> Self {
        Self {
            lines: Lines::new(),
            bits: 0,
            answer: 0,
            shifting: 0,
            cut: false,
            frozen: None,
            error_flag: false,
            glitches: 0,
        }
    }

    /// Whether this level of chip select latches the angle for the next answer.
    pub(crate) const fn latches(&self, select: bool) -> bool {
        select && self.lines.is_selected()
    }

    /// Data output; `None` while not selected or disconnected.
    pub fn output(&self) -> Option<bool> {
        (self.lines.is_selected() && !self.cut).then_some(self.shifting & 0x8000 != 0)
    }

    /// Updates the lines; `angle_counts` is used where [`Self::latches`] is true.
    pub(crate) fn lines(&mut self, select: bool, clock: bool, angle_counts: Option<u16>) {
        match self.lines.step(Take::Falling, select, clock, true) {
            Event::None => (),
            Event::Selected => (self.bits, self.shifting) = (0, self.answer),
            Event::Bit(_) => self.bits += 1,
            // The first bit is already output at the first rising edge, which therefore shifts nothing.
            Event::Next if self.bits > 0 => self.shifting <<= 1,
            Event::Next => (),
            Event::Released => self.latch(angle_counts.unwrap_or(0)),
        }
    }

    /// Answer to the completed word: angle, error flag for a frame of another length, even parity.
    fn latch(&mut self, angle_counts: u16) {
        let damaged = self.error_flag || self.bits != 16;
        let angle = self.frozen.unwrap_or(angle_counts) & 0x3fff;
        let word = angle | u16::from(damaged) << 14;
        self.answer = word | ((word.count_ones() & 1) as u16) << 15;
        if self.glitches > 0 {
            self.glitches -= 1;
            self.answer ^= 1 << (self.glitches % 14);
        }
    }
}

impl Default for As5047 {
    fn default() -> Self {
        Self::new()
    }
}
