//! Flight cards: what control asks of the motor's interrupt.

use motor::Ask;
use parts::order::{Deadline, ask, word};
use parts::vesc6::PATIENCE_CALLS;
use proptest::prelude::*;

proptest! {
    /// Situation: any order, NaN of any bits included. Must hold: it arrives as it was sent; a torque is never taken for
    /// another order.
    #[test]
    fn orders_arrive(bits: u32) {
        for sent in [Ask::Off, Ask::Align, Ask::Torque(f32::from_bits(bits))] {
            let arrived = ask(word(sent));
            match sent {
                Ask::Torque(nm) if nm.is_nan() => {
                    prop_assert!(matches!(arrived, Ask::Torque(nm) if nm.is_nan()), "{:?}", arrived);
                }
                sent => prop_assert_eq!(arrived, sent),
            }
        }
    }
}

/// Situation: control orders 5 N m each millisecond, then falls silent, then speaks again. Must hold: before the first
/// order nothing is done; the bridge opens in the call after the patience, not before; with the next order it goes on.
#[test]
fn silence_opens_the_bridge() {
    let torque = Ask::Torque(5.0);
    let mut deadline = Deadline::default();
    assert_eq!(deadline.step(0, torque, PATIENCE_CALLS), Ask::Off, "nothing was ordered yet");
    for call in 0..2000_u32 {
        let given = deadline.step(1 + call / 20, torque, PATIENCE_CALLS);
        assert_eq!(given, torque, "call {call}");
    }
    // The last new order was 19 calls ago.
    let open = (0..1000).find(|_| deadline.step(100, torque, PATIENCE_CALLS) == Ask::Off);
    assert_eq!(open, Some(81));
    assert!(deadline.is_over(PATIENCE_CALLS));
    assert_eq!(deadline.step(101, torque, PATIENCE_CALLS), torque);
    assert!(!deadline.is_over(PATIENCE_CALLS));
}
