//! The command from control to the motor interrupt.

use devices::vesc6::COMMAND_TIMEOUT_CALLS;
use motor::MotorCommand;
use motor::command_word::{Deadline, command, word};
use proptest::prelude::*;

proptest! {
    /// Situation: any command, NaN of any bits included. Must hold: it is decoded as it was encoded; a torque is
    /// never another command.
    #[test]
    fn commands_are_unchanged_by_encoding(bits: u32) {
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

/// Situation: control commands 5 N m each millisecond, then stops, then resumes. Must hold: nothing before the first
/// command; the bridge opens in the call after the timeout, not before; with the next command the torque returns.
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
