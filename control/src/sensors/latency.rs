//! Aligns sensors of different latency to one instant by delaying the faster ones.
//!
//! No value becomes older than the slowest sensor's. With equal latencies the values pass unchanged. After a reset or a
//! gap there is no output until the history is long enough; no value is extrapolated.

use crate::param::{ParamSpec, ParamVisitor};
use crate::sensors::measurements::SpeedInterval;

/// Largest latency of a sensor \[control periods\].
pub const MAX_LATENCY_TICKS: u16 = 31;

const CAPACITY: usize = MAX_LATENCY_TICKS as usize + 1;

/// Latency of each sensor's newest sample, in whole control periods.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Latency {
    /// Of the roll rate, 0..=[`MAX_LATENCY_TICKS`].
    pub roll_rate_ticks: u16,
    /// Of the wheel speed, 0..=[`MAX_LATENCY_TICKS`].
    pub speed_ticks: u16,
}

impl Latency {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        let max = f32::from(MAX_LATENCY_TICKS);
        to.count(&ParamSpec::new("latency", "roll_rate_ticks", 0.0, max), &mut self.roll_rate_ticks);
        to.count(&ParamSpec::new("latency", "speed_ticks", 0.0, max), &mut self.speed_ticks);
    }
}

/// Inputs of the law at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct Aligned {
    /// Roll rate \[rad/s\].
    pub roll_rate_rad_s: f32,
    /// Speed \[m/s\].
    pub speed: SpeedInterval,
}

/// Valid values of the last periods, without gaps.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct History {
    recent: [Aligned; CAPACITY],
    /// Index of the newest value in the ring; the previous one is at the index before it.
    newest: usize,
    /// Number of periods since the last gap, saturating.
    length: usize,
}

impl History {
    /// Clears the history; called in a period without a valid roll rate or speed.
    pub fn clear(&mut self) {
        self.length = 0;
    }

    /// Stores the newest values and returns those of one common instant, or `None` while the history of the faster
    /// sensor does not yet reach back to the slower sensor's sample.
    pub fn align(&mut self, latency: &Latency, newest: Aligned) -> Option<Aligned> {
        let Latency { roll_rate_ticks, speed_ticks } = *latency;
        if roll_rate_ticks == speed_ticks {
            return Some(newest);
        }
        self.newest = (self.newest + 1) % CAPACITY;
        if let Some(slot) = self.recent.get_mut(self.newest) {
            *slot = newest;
        }
        self.length = self.length.saturating_add(1);
        let lag_ticks = usize::from(roll_rate_ticks.abs_diff(speed_ticks));
        if self.length <= lag_ticks {
            return None;
        }
        let delayed = self.recent.get((self.newest + CAPACITY - lag_ticks) % CAPACITY)?;
        Some(if roll_rate_ticks > speed_ticks {
            Aligned { speed: delayed.speed, ..newest }
        } else {
            Aligned { speed: newest.speed, ..*delayed }
        })
    }
}
