//! Whether a rotor turns slowly enough for something, by its encoder's counts once a millisecond.

use crate::as5047::COUNTS;

/// Samples in a row that must be slow.
const ENOUGH: u8 = 10;

/// What is remembered.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slow {
    counts: Option<u16>,
    slow: u8,
    /// The newest speed, either way \[turns/s\]; `None` before two samples in a row.
    pub turns_s: Option<f32>,
}

impl Slow {
    /// One millisecond later: the encoder's counts, if it gave some; whether the rotor has been slower than
    /// `most_turns_s` for the last ten of them.
    pub fn step(&mut self, counts: Option<u16>, most_turns_s: f32) -> bool {
        let before = core::mem::replace(&mut self.counts, counts);
        self.turns_s = before.zip(counts).map(|(before, now)| turns_s(before, now));
        let slow = self.turns_s.is_some_and(|turns_s| turns_s < most_turns_s);
        self.slow = if slow { self.slow.saturating_add(1) } else { 0 };
        self.slow >= ENOUGH
    }
}

/// Speed of the short way from one sample to the next, either way \[turns/s\].
fn turns_s(before: u16, now: u16) -> f32 {
    let way = now.wrapping_sub(before) & (COUNTS - 1);
    1e3 * f32::from(way.min(COUNTS - way)) / f32::from(COUNTS)
}
