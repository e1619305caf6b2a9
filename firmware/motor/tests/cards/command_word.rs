//! Flight cards: what control asks of the motor's interrupt.

use devices::vesc6::COMMAND_TIMEOUT_CALLS;
use motor::MotorCommand;
use motor::command_word::{Deadline, command, word};
use proptest::prelude::*;

proptest! {
    /// Situation: any order, NaN of any bits included. Must hold: it arrives as it was sent; a torque is never taken for
    /// another order.
    #[test]
    fn orders_arrive(bits: u32) {
        for sent in [MotorCommand::Off, MotorCommand::Align, MotorCommand::Torque(f32::from_bits(bits))] {
            let arrived = command(word(sent));
            match sent {
                MotorCommand::Torque(nm) if nm.is_nan() => {
                    prop_assert!(matches!(arrived, MotorCommand::Torque(nm) if nm.is_nan()), "{:?}", arrived);
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
    let torque = MotorCommand::Torque(5.0);
    let mut deadline = Deadline::default();
    assert_eq!(deadline.step(0, torque, COMMAND_TIMEOUT_CALLS), MotorCommand::Off, "nothing was ordered yet");
    for call in 0..2000_u32 {
        let given = deadline.step(1 + call / 20, torque, COMMAND_TIMEOUT_CALLS);
        assert_eq!(given, torque, "call {call}");
    }
    // The last new order was 19 calls ago.
    let open = (0..1000).find(|_| deadline.step(100, torque, COMMAND_TIMEOUT_CALLS) == MotorCommand::Off);
    assert_eq!(open, Some(81));
    assert!(deadline.is_over(COMMAND_TIMEOUT_CALLS));
    assert_eq!(deadline.step(101, torque, COMMAND_TIMEOUT_CALLS), torque);
    assert!(!deadline.is_over(COMMAND_TIMEOUT_CALLS));
}
