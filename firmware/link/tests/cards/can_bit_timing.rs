//! CAN bit timing.

use devices::vesc6::CAN_CLOCK_HZ;
use link::can::BIT_HZ;
use link::can_bit_timing::bit_timing;
use proptest::prelude::*;

/// Situation: the board's clock and bit rate. Must hold: 84 clock cycles per bit, so the rate is exact; the sample
/// point is as near to 87.5 % as a divisor of 84 allows, which is 12 of 14 quanta.
#[test]
fn the_board_keeps_the_rate() {
    let timing = bit_timing(CAN_CLOCK_HZ, BIT_HZ).unwrap();
    assert_eq!(u32::from(timing.prescaler) * u32::from(timing.quanta()) * BIT_HZ, CAN_CLOCK_HZ);
    assert!((0.857..0.858).contains(&timing.sample_point()), "{timing:?}");
    assert_eq!((timing.prescaler, timing.segment_1, timing.segment_2, timing.jump), (6, 11, 2, 2));
}

/// Situation: clocks with a multiple of eight or sixteen cycles per bit. Must hold: the sample point is at 87.5 %.
#[test]
fn the_sample_point_is_exact_where_possible() {
    for clock_hz in [8_000_000, 16_000_000, 24_000_000, 48_000_000] {
        assert_eq!(bit_timing(clock_hz, BIT_HZ).unwrap().sample_point(), 0.875, "{clock_hz} Hz");
    }
}

/// Situation: clocks that are too slow or no multiple of the rate, no clock, no rate. Must hold: there is no timing.
#[test]
fn an_impossible_rate_is_rejected() {
    for (clock_hz, bit_hz) in
        [(3_500_000, BIT_HZ), (42_000_001, BIT_HZ), (42_000_000, 1), (0, BIT_HZ), (1, 0)]
    {
        assert_eq!(bit_timing(clock_hz, bit_hz), None, "{clock_hz} Hz, {bit_hz} bit/s");
    }
}

proptest! {
    /// Situation: any clock and rate, and matching ones. Must hold: a timing found is exact, and every number fits
    /// its register.
    #[test]
    fn a_timing_is_exact(clock: u32, bit in 1_u32.., times in 1_u32..4000) {
        let bit_hz = bit % 1_000_000 + 1;
        for (clock_hz, bit_hz) in [(clock, bit), (bit_hz * times, bit_hz)] {
            let Some(t) = bit_timing(clock_hz, bit_hz) else { continue };
            let clocks = u64::from(t.prescaler) * u64::from(t.quanta());
            prop_assert_eq!(clocks * u64::from(bit_hz), u64::from(clock_hz), "{:?}", t);
            prop_assert!((1..=1024).contains(&t.prescaler) && (1..=16).contains(&t.segment_1), "{:?}", t);
            prop_assert!((1..=8).contains(&t.segment_2) && (1..=4.min(t.segment_2)).contains(&t.jump), "{:?}", t);
        }
    }
}
