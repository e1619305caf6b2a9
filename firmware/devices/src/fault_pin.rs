//! A fault pin, active low, as it is sampled once in each call of the motor's interrupt.

/// The newest samples, and what came of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FaultPin {
    /// Low where set, the newest in bit 0.
    low: u8,
    /// Samples that were low alone: pulses too short to be a fault. Wrapping.
    pub pulses: u32,
}

impl FaultPin {
    /// One sample; whether there is a fault: two of the last three are low. A disturbance beside a switching bridge is
    /// shorter than the time between two samples; a fault stays.
    pub fn step(&mut self, low: bool) -> bool {
        self.low = self.low << 1 | u8::from(low);
        let last = self.low & 0b111;
        self.pulses = self.pulses.wrapping_add(u32::from(last == 0b010));
        last.count_ones() >= 2
    }
}
