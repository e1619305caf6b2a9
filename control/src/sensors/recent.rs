//! Bounds of a wheel's speed over its newest samples.

use crate::maths::{max, min};
use crate::sensors::frame::MISSING;
use crate::sensors::measurements::SpeedInterval;
use crate::sensors::validation::{MAX_RECENT_SAMPLES, ValidationConfig, ValidationPlan};
use core::hint::cold_path;

/// Newest samples of a wheel's speed.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub(super) struct Recent {
    /// Samples before the newest in a ring, NaN where there was none; `next` is the index of the next sample.
    samples: [f32; MAX_RECENT_SAMPLES - 1],
    next: usize,
    /// Bounds of these samples and the newest.
    low: f32,
    high: f32,
    /// Age of the newest sample in the next period if no new one arrives \[control periods\].
    held_age: u16,
}

impl Default for Recent {
    fn default() -> Self {
        Self { samples: [f32::NAN; MAX_RECENT_SAMPLES - 1], next: 0, low: 0.0, high: 0.0, held_age: MISSING }
    }
}

impl Recent {
    /// Bounds of the speed from the newest sample with its age, and the samples before it. `None`, and the history is
    /// cleared, if the wheel is not valid.
    pub(super) fn bounds(
        &mut self,
        config: &ValidationConfig,
        plan: &ValidationPlan,
        newest: Option<([f32; 1], u16)>,
    ) -> Option<SpeedInterval> {
        let Some(([newest], age)) = newest else {
            *self = Self::default();
            return None;
        };
        if age != self.held_age {
            self.add(plan.earlier_samples, newest);
        }
        self.held_age = age.saturating_add(1);
        let (mut low, mut high) = (self.low, self.high);
        if age > config.drift_after_ticks {
            cold_path();
            let late_ticks = f32::from(age - config.drift_after_ticks);
            let drift = plan.drift_m_s * late_ticks;
            (low, high) = (low - drift, high + drift);
        }
        Some(SpeedInterval { low, newest, high })
    }

    /// Stores a new sample; the bounds span it and up to `earlier_samples` samples before it.
    fn add(&mut self, earlier_samples: usize, newest: f32) {
        let (mut low, mut high) = (newest, newest);
        for sample in self.samples.iter().take(earlier_samples) {
            (low, high) = (min(*sample, low), max(*sample, high));
        }
        (self.low, self.high) = (low, high);
        if let Some(slot) = self.samples.get_mut(self.next) {
            *slot = newest;
        }
        self.next = if self.next + 1 < earlier_samples { self.next + 1 } else { 0 };
    }
}
