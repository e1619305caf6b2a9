//! The time of the tasks.

use devices::ticks::ticks;
use proptest::prelude::*;

/// Number of half-range interrupts until `taken`.
fn halves(taken: u64) -> u32 {
    (taken >> 31) as u32
}

/// Situation: the counter at the edges of its half ranges, over three hours. Action: read it before and after the
/// edge's interrupt. Must hold: the time is exact to the tick in both cases.
#[test]
fn time_is_right_at_every_edge() {
    for edge in 1..6_u64 {
        let edge = edge << 31;
        for now in edge - 2..edge + 2 {
            assert_eq!(ticks(halves(now), now as u32), now);
        }
        for now in edge..edge + 2 {
            assert_eq!(ticks(halves(edge - 1), now as u32), now, "the interrupt is still to come");
        }
    }
}

proptest! {
    /// Situation: any time of the first year, after a halt of the chip of up to 35 minutes. Must hold: no tick is lost.
    #[test]
    fn a_halt_loses_no_time(now in 0_u64..31_536_000_000_000, stood_us in 0_u64..2_100_000_000) {
        let taken = now.saturating_sub(stood_us);
        prop_assert_eq!(ticks(halves(taken), now as u32), now);
    }
}
