//! Age of a sensor's newest sample, counted in control periods.

use control::sensors::frame::MISSING;

/// Age of the newest sample; [`MISSING`] before the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Age(u16);

impl Default for Age {
    fn default() -> Self {
        Self(MISSING)
    }
}

impl Age {
    /// Present age \[control periods\].
    pub fn now(self) -> u16 {
        self.0
    }

    /// One control period with or without a new sample; returns the present age \[control periods\].
    pub fn step(&mut self, new: bool) -> u16 {
        self.0 = if new { 0 } else { self.0.saturating_add(1) };
        self.0
    }
}
