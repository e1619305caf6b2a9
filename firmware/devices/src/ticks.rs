//! 64-bit time from a 32-bit counter with an interrupt at zero and at half of its range.

/// Ticks since the start, from the number of interrupts `halves` and the counter, read after it.
///
/// An interrupt can be late by up to half a counter range: if the counter is in the half that does not match the
/// number of interrupts, one interrupt is pending.
pub const fn ticks(halves: u32, counter: u32) -> u64 {
    ((halves as u64) << 31) + (counter ^ (halves & 1) << 31) as u64
}
