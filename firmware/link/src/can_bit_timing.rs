//! A bit of CAN in quanta of the chip's clock.
//!
//! A bit begins with one quantum for its edge; segment 1 goes on to the instant at which it is read, segment 2 to its
//! end. Source: RM0090, bxCAN, bit timing.

/// Clocks to a quantum, and quanta to the parts of a bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BitTiming {
    /// Clocks to a quantum, 1 to 1024.
    pub prescaler: u16,
    /// From the edge to the instant of reading \[quanta\], 1 to 16.
    pub segment_1: u8,
    /// From there to the end \[quanta\], 1 to 8.
    pub segment_2: u8,
    /// The most by which a bit is made longer or shorter to keep up with another's clock \[quanta\], 1 to 4.
    pub jump: u8,
}

impl BitTiming {
    /// A bit \[quanta\].
    pub fn quanta(&self) -> u8 {
        1 + self.segment_1 + self.segment_2
    }

    /// Where in the bit it is read, 0 to 1.
    pub fn sample_point(&self) -> f32 {
        1.0 - f32::from(self.segment_2) / f32::from(self.quanta())
    }
}

/// Quanta of a bit that the chip's segments can make up.
const QUANTA: core::ops::RangeInclusive<u8> = 8..=25;

/// The timing of exactly this bit rate \[bit/s\] from this clock \[Hz\] that is read nearest to 87.5 % of the bit, as CiA
/// 301 recommends; of several the one with most quanta. `None` where the clock has no such rate.
pub fn bit_timing(clock_hz: u32, bit_hz: u32) -> Option<BitTiming> {
    let distance = |timing: &BitTiming| (1e3 * libm::fabsf(timing.sample_point() - 0.875)) as u32;
    QUANTA.rev().filter_map(|quanta| of_quanta(clock_hz, bit_hz, quanta)).min_by_key(distance)
}

/// The timing with this many quanta to a bit.
fn of_quanta(clock_hz: u32, bit_hz: u32, quanta: u8) -> Option<BitTiming> {
    let quantum_hz = bit_hz.checked_mul(u32::from(quanta))?;
    if clock_hz.checked_rem(quantum_hz)? != 0 {
        return None;
    }
    let prescaler = u16::try_from(clock_hz.checked_div(quantum_hz)?).ok()?;
    // An eighth, rounded; more where segment 1 can't be that long.
    let segment_2 = ((quanta + 4) / 8).max(quanta.saturating_sub(17));
    let segment_1 = quanta - 1 - segment_2;
    (1..=1024).contains(&prescaler).then_some(BitTiming {
        prescaler,
        segment_1,
        segment_2,
        jump: segment_2.min(4),
    })
}
