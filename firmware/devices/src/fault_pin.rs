//! Filter of an active-low fault pin that is sampled once per call of the motor interrupt.

/// Recent samples and the number of short pulses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FaultPin {
    /// Recent samples, 1 for low, the newest in bit 0.
    low: u8,
    /// Number of single low samples: pulses too short to be a fault, wrapping.
    pub pulses: u32,
}

impl FaultPin {
    /// Adds one sample; returns whether there is a fault: two of the last three samples are low. Disturbances by the
    /// switching bridge are shorter than the sampling interval; a fault lasts.
    pub fn step(&mut self, low: bool) -> bool {
        self.low = self.low << 1 | u8::from(low);
        let last = self.low & 0b111;
        self.pulses = self.pulses.wrapping_add(u32::from(last == 0b010));
        last.count_ones() >= 2
    }
}
