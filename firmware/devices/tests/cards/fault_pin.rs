//! The gate driver's fault pin.

use devices::fault_pin::FaultPin;

/// Situation: no fault for a second. Action: the pin goes low and stays low. Must hold: a fault at the second low
/// sample, not at the first, and at every later one.
#[test]
fn a_fault_is_one_at_the_second_sample() {
    let mut pin = FaultPin::default();
    assert!((0..20_000).all(|_| !pin.step(false)));
    let faults: Vec<_> = (0..100).map(|_| pin.step(true)).collect();
    assert_eq!(faults.iter().position(|fault| *fault), Some(1));
    assert!(faults[1..].iter().all(|fault| *fault));
    assert_eq!(pin.pulses, 0);
}

/// Situation: pulses of one sample every four samples, like a disturbance. Must hold: none is a fault, each is
/// counted once.
#[test]
fn short_pulses_are_counted() {
    let mut pin = FaultPin::default();
    for _ in 0..1000 {
        assert!([true, false, false, false].iter().all(|low| !pin.step(*low)));
    }
    assert_eq!(pin.pulses, 1000);
}

/// Situation: two low samples with a high one between them. Must hold: a fault.
#[test]
fn two_of_three_are_a_fault() {
    let mut pin = FaultPin::default();
    assert_eq!([true, false, true].map(|low| pin.step(low)), [false, false, true]);
}
