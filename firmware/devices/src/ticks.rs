//! Time of a counter of 32 bits that is interrupted twice a round, at 0 and at half.

/// Ticks since the start: of `halves`, the interrupts so far, and the counter as it is read after them.
///
/// An interrupt may be late by up to half a round: where the counter is in the half that the number of interrupts does
/// not belong to, one of them is still to come.
pub const fn ticks(halves: u32, counter: u32) -> u64 {
    ((halves as u64) << 31) + (counter ^ (halves & 1) << 31) as u64
}
