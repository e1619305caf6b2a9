//! Conversion of ADC counts.

use devices::analog::{FULL_SCALE, Gauge};
use devices::vesc6::{BOARD_TEMPERATURE, SHUNT, STEER_RAD, SUPPLY};

/// Counts of a voltage, rounded as the chip's data sheet says.
fn counts(volt: f64) -> u16 {
    (volt / 3.3 * 4095.0).round() as u16
}

/// Situation: a current through a shunt, amplified, above half of the reference. Action: convert it to counts and back.
/// Must hold: the same current to half a count, with the same sign; beyond the range, none.
#[test]
fn a_current_comes_back() {
    let step = 3.3 / 4095.0 / 0.5e-3 / 20.0;
    assert!((0.080..0.081).contains(&step), "the example's step: {step}");
    for ampere in [-150.0, -15.0, -0.1, 0.0, 0.1, 7.0, 160.0] {
        let read = f64::from(SHUNT.ampere(counts(1.65 + ampere * 0.5e-3 * 20.0)));
        assert!((read - ampere).abs() <= 0.51 * step, "{ampere} A reads as {read} A");
    }
    let reversed = devices::analog::Shunt { reversed: true, ..SHUNT };
    assert_eq!(reversed.ampere(2200), -SHUNT.ampere(2200));
    for rail in [0, 16, 4079, FULL_SCALE, u16::MAX] {
        assert!(SHUNT.ampere(rail).is_nan(), "{rail} counts are no current");
    }
}

/// Situation: bus voltages and temperatures. Action: convert to counts and back. Must hold: the same to a count; an
/// open or shorted thermistor has no temperature.
#[test]
fn supply_and_temperature_come_back() {
    for volt in [5.0, 24.0, 36.0, 57.0] {
        let read = f64::from(SUPPLY.volt(counts(volt * 2200.0 / 41_200.0)));
        assert!((read - volt).abs() < 0.009, "{volt} V reads as {read} V");
    }
    for celsius in [-20.0_f64, 25.0, 80.0, 100.0] {
        let ohm = 10_000.0 * (3380.0 * (1.0 / (celsius + 273.15) - 1.0 / 298.15)).exp();
        let read = f64::from(BOARD_TEMPERATURE.celsius(counts(3.3 * 10_000.0 / (10_000.0 + ohm))));
        assert!((read - celsius).abs() < 0.1, "{celsius} deg C reads as {read}");
    }
    for rail in [0, 10, 4090, FULL_SCALE] {
        assert!(BOARD_TEMPERATURE.celsius(rail).is_nan(), "{rail} counts are no temperature");
    }
}

/// Situation: a steer sensor, turned from end to end, then open and shorted. Must hold: the angle rises to the right
/// with zero in the middle; a broken wire gives no angle.
#[test]
fn a_broken_wire_is_no_angle() {
    let half = core::f32::consts::FRAC_PI_2;
    assert_eq!(STEER_RAD.value(410), Some(-half));
    assert_eq!(STEER_RAD.value(3685), Some(half));
    let middle = STEER_RAD.value(2048).expect("an angle");
    assert!(middle.abs() < 1e-3, "{middle}");
    let fine = STEER_RAD.value(2049).expect("an angle") - middle;
    assert!((0.9e-3..1.0e-3).contains(&fine), "a count is {fine} rad");
    for broken in [0, 409, 3686, FULL_SCALE, u16::MAX] {
        assert_eq!(STEER_RAD.value(broken), None, "{broken}");
    }
    let nothing = Gauge { least_counts: 5, most_counts: 4, ..STEER_RAD };
    assert_eq!(nothing.value(5), None);
}
