//! Detects a slowly turning rotor from encoder counts once per millisecond.

use crate::as5047::COUNTS;

/// Number of consecutive slow samples required.
const ENOUGH: u8 = 10;

/// State of the detection.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RotorSpeedCheck {
    counts: Option<u16>,
    slow: u8,
    /// Newest absolute speed \[turns/s\]; `None` before two consecutive samples.
    pub turns_s: Option<f32>,
}

impl RotorSpeedCheck {
    /// One millisecond with the encoder's counts, if valid; returns whether the rotor has been slower than
    /// `most_turns_s` for the last ten samples.
    pub fn step(&mut self, counts: Option<u16>, most_turns_s: f32) -> bool {
        let before = core::mem::replace(&mut self.counts, counts);
        self.turns_s = before.zip(counts).map(|(before, now)| turns_s(before, now));
        let slow = self.turns_s.is_some_and(|turns_s| turns_s < most_turns_s);
        self.slow = if slow { self.slow.saturating_add(1) } else { 0 };
        self.slow >= ENOUGH
    }
}

/// Absolute speed over the shorter arc between two samples \[turns/s\].
fn turns_s(before: u16, now: u16) -> f32 {
    let way = now.wrapping_sub(before) & (COUNTS - 1);
    1e3 * f32::from(way.min(COUNTS - way)) / f32::from(COUNTS)
}
