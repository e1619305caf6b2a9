//! Counts control steps, missed deadlines, and the longest response time.

use embassy_time::{Duration, Instant};

/// Period of the control step: 1 kHz.
pub const PERIOD: Duration = Duration::from_millis(1);

/// Counters of the control steps.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deadlines {
    /// Number of steps.
    pub steps: u32,
    /// Number of steps that ended after the next release.
    pub late: u32,
    /// Longest time from a step's release to its end \[us\].
    pub worst_us: u32,
}

impl Deadlines {
    /// Counts a step with its release and its end.
    pub fn finished(&mut self, release: Instant, end: Instant) {
        let took = end.saturating_duration_since(release);
        self.steps = self.steps.wrapping_add(1);
        self.late = self.late.wrapping_add(u32::from(took > PERIOD));
        self.worst_us = self.worst_us.max(took.as_micros() as u32);
    }

    /// Number of periods in `elapsed` whose step was late or missing.
    pub fn missed(&self, elapsed: Duration) -> u32 {
        let released = (elapsed.as_ticks() / PERIOD.as_ticks()) as u32;
        self.late + released.saturating_sub(self.steps)
    }
}
