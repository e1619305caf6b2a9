//! Brings sensors of different latency to one instant by remembering the faster ones.
//!
//! It never makes anything later than the slowest sensor already is; with equal latencies the
//! values pass through untouched. After a reset, or a gap, nothing comes out until enough has gone
//! in: no motion is invented.

use crate::param::{ParamSpec, ParamVisitor};
use crate::sensors::validation::SpeedInterval;

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
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        let max = f32::from(MAX_LATENCY_TICKS);
        to.count(&ParamSpec::new("latency", "roll_rate_ticks", 0.0, max), &mut self.roll_rate_ticks);
        to.count(&ParamSpec::new("latency", "speed_ticks", 0.0, max), &mut self.speed_ticks);
    }
}

/// What the law needs of one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Aligned {
    /// Roll rate \[rad/s\].
    pub roll_rate_rad_s: f32,
    /// Speed \[m/s\].
    pub speed: SpeedInterval,
}

/// The believed values of the last periods, without gaps.
#[derive(Clone, Debug, Default)]
pub struct History {
    recent: [Aligned; CAPACITY],
    /// Where the newest stands; the one before it stands before it, round the end.
    newest: usize,
    /// How many periods there are since the last gap, as far as they matter.
    known: usize,
}

impl History {
    /// Forgets everything; call it when a period brought no believable frame.
    pub fn clear(&mut self) {
        self.known = 0;
    }

    /// Takes in the newest values and gives back one instant's, or `None` while the faster
    /// sensor's past does not yet reach back to the slower one's present.
    pub fn align(&mut self, latency: &Latency, newest: Aligned) -> Option<Aligned> {
        let Latency { roll_rate_ticks, speed_ticks } = *latency;
        if roll_rate_ticks == speed_ticks {
            return Some(newest);
        }
        self.newest = (self.newest + 1) % CAPACITY;
        if let Some(place) = self.recent.get_mut(self.newest) {
            *place = newest;
        }
        self.known = self.known.saturating_add(1);
        let apart = usize::from(roll_rate_ticks.abs_diff(speed_ticks));
        if self.known <= apart {
            return None;
        }
        let then = self.recent.get((self.newest + CAPACITY - apart) % CAPACITY)?;
        Some(if roll_rate_ticks > speed_ticks {
            Aligned { speed: then.speed, ..newest }
        } else {
            Aligned { speed: newest.speed, ..*then }
        })
    }
}
