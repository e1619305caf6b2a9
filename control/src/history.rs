//! Brings sensors of different latency to one instant by remembering the faster ones.
//!
//! It never makes anything later than the slowest sensor already is; with equal latencies the
//! values pass through untouched. After a reset, or a gap, nothing comes out until enough has gone
//! in: no motion is invented.

use crate::input::Bounds;
use crate::param::{Leaf, Visit};
use heapless::Deque;

/// Most control periods by which two sensors' latencies may differ.
pub const MAX_LATENCY_TICKS: u16 = 31;

const CAPACITY: usize = MAX_LATENCY_TICKS as usize + 1;

/// How late each sensor's newest sample is, in whole control periods.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Latency {
    /// Of the roll rate, 0..=[`MAX_LATENCY_TICKS`].
    pub roll_rate_ticks: u16,
    /// Of the wheel speed, 0..=[`MAX_LATENCY_TICKS`].
    pub speed_ticks: u16,
}

impl Latency {
    /// Shows every parameter.
    pub fn leaves<V: Visit>(&mut self, to: &mut V) {
        let max = f32::from(MAX_LATENCY_TICKS);
        to.count(&Leaf::new("latency", "roll_rate_ticks", 0.0, max), &mut self.roll_rate_ticks);
        to.count(&Leaf::new("latency", "speed_ticks", 0.0, max), &mut self.speed_ticks);
    }
}

/// What the law needs of one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Aligned {
    /// Roll rate \[rad/s\].
    pub roll_rate_rad_s: f32,
    /// Speed \[m/s\].
    pub speed: Bounds,
}

/// The believed values of the last periods, newest last, without gaps.
#[derive(Clone, Debug, Default)]
pub struct History {
    recent: Deque<Aligned, CAPACITY>,
}

impl History {
    /// Forgets everything; call it when a period brought no believable frame.
    pub fn clear(&mut self) {
        self.recent.clear();
    }

    /// Takes in the newest values and gives back one instant's, or `None` while the faster
    /// sensor's past does not yet reach back to the slower one's present.
    pub fn align(&mut self, latency: &Latency, newest: Aligned) -> Option<Aligned> {
        let Latency { roll_rate_ticks, speed_ticks } = *latency;
        if roll_rate_ticks == speed_ticks {
            return Some(newest);
        }
        if self.recent.is_full() {
            let _ = self.recent.pop_front();
        }
        // There is room: the oldest was dropped above.
        let _ = self.recent.push_back(newest);
        let newest = self.recent.len().saturating_sub(1);
        let back = |ticks: u16| newest.checked_sub(usize::from(ticks)).and_then(|at| self.recent.get(at));
        let slowest = roll_rate_ticks.max(speed_ticks);
        let roll_rate = back(slowest.saturating_sub(roll_rate_ticks))?;
        let speed = back(slowest.saturating_sub(speed_ticks))?;
        Some(Aligned { roll_rate_rad_s: roll_rate.roll_rate_rad_s, speed: speed.speed })
    }
}
