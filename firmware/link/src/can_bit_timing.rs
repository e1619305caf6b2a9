//! Bit timing of the CAN controller: clock divider and bit segments for a bit rate.
//!
//! A bit starts with one synchronisation quantum; segment 1 lasts to the sample point, segment 2 to the end of the bit.
//! Source: RM0090, bxCAN, bit timing.

/// Clock cycles per quantum, and quanta per segment of a bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BitTiming {
    /// Clock cycles per quantum, 1 to 1024.
    pub prescaler: u16,
    /// Time from the synchronisation quantum to the sample point \[quanta\], 1 to 16.
    pub segment_1: u8,
    /// Time from the sample point to the end of the bit \[quanta\], 1 to 8.
    pub segment_2: u8,
    /// Synchronisation jump width: largest change of a bit's length to resynchronise with another node \[quanta\], 1
    /// to 4.
    pub jump: u8,
}

impl BitTiming {
    /// Length of a bit \[quanta\].
    pub fn quanta(&self) -> u8 {
        1 + self.segment_1 + self.segment_2
    }

    /// Sample point as a fraction of the bit, 0 to 1.
    pub fn sample_point(&self) -> f32 {
        1.0 - f32::from(self.segment_2) / f32::from(self.quanta())
    }
}

/// Range of the quanta per bit that the chip's segments allow.
const QUANTA: core::ops::RangeInclusive<u8> = 8..=25;

/// Timing for exactly `bit_hz` \[bit/s\] from a clock of `clock_hz` \[Hz\], with the sample point nearest to 87.5 % as
/// CiA 301 recommends; among equals the one with most quanta. `None` if the clock can't give this rate.
pub fn bit_timing(clock_hz: u32, bit_hz: u32) -> Option<BitTiming> {
    let distance = |timing: &BitTiming| (1e3 * libm::fabsf(timing.sample_point() - 0.875)) as u32;
    QUANTA.rev().filter_map(|quanta| of_quanta(clock_hz, bit_hz, quanta)).min_by_key(distance)
}

/// Timing with the given number of quanta per bit.
fn of_quanta(clock_hz: u32, bit_hz: u32, quanta: u8) -> Option<BitTiming> {
    let quantum_hz = bit_hz.checked_mul(u32::from(quanta))?;
    if clock_hz.checked_rem(quantum_hz)? != 0 {
        return None;
    }
    let prescaler = u16::try_from(clock_hz.checked_div(quantum_hz)?).ok()?;
    // An eighth of the bit, rounded; more where segment 1 would exceed its range.
    let segment_2 = ((quanta + 4) / 8).max(quanta.saturating_sub(17));
    let segment_1 = quanta - 1 - segment_2;
    (1..=1024).contains(&prescaler).then_some(BitTiming {
        prescaler,
        segment_1,
        segment_2,
        jump: segment_2.min(4),
    })
}
