//! Was every control step done within its period?

use embassy_time::{Duration, Instant};

/// How often the control step is released: 1 kHz.
pub const PERIOD: Duration = Duration::from_millis(1);

/// The steps done so far, and how late.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deadlines {
    /// Steps done.
    pub steps: u32,
    /// Steps that ended after the next one's release.
    pub late: u32,
    /// Longest time from a step's release to its end \[us\].
    pub worst_us: u32,
}

impl Deadlines {
    /// Counts a step that was released and ended at these instants.
    pub fn finished(&mut self, release: Instant, end: Instant) {
        let took = end.saturating_duration_since(release);
        self.steps = self.steps.wrapping_add(1);
        self.late = self.late.wrapping_add(u32::from(took > PERIOD));
        self.worst_us = self.worst_us.max(took.as_micros() as u32);
    }

    /// Periods of `elapsed` whose step was late or never done.
    pub fn missed(&self, elapsed: Duration) -> u32 {
        let released = (elapsed.as_ticks() / PERIOD.as_ticks()) as u32;
        self.late + released.saturating_sub(self.steps)
    }
}
