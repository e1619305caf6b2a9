//! Consistency of the board's constants.

use devices::vesc6::*;

/// Situation: the board's motor configuration. Must hold: the motor loop accepts it, and torque is impossible until the
/// encoder's offset is found and stored.
#[test]
fn the_motor_is_accepted_and_not_aligned() {
    assert!(MOTOR.plan().is_ok());
    assert_eq!(MOTOR.encoder.offset_turns, None);
    assert_eq!(MOTOR.encoder.counts, 16_384);
}

/// Situation: currents and voltages at which the motor loop must act. Must hold: the board can measure each, with a
/// margin.
#[test]
fn the_limits_can_be_measured() {
    let most_a = SHUNT.ampere(4078);
    assert!((160.0..166.0).contains(&most_a), "{most_a} A");
    assert!(MOTOR.sensors.range_a <= most_a);
    assert!(MOTOR.sensors.trip_a < 0.5 * most_a);
    let most_v = SUPPLY.volt(4095);
    assert!(MOTOR.supply.high_v < most_v && (61.0..63.0).contains(&most_v), "{most_v} V");
    assert!(BOARD_TEMPERATURE.celsius(3800) > MOTOR.temperature.hot_c, "{}", BOARD_TEMPERATURE.celsius(3800));
}

/// Situation: the largest current that the motor loop permits, 1.3 times its trip (docs/motor.md), through a switch
/// that drops 403 mV at 150 A. Must hold: the gate driver's over-current voltage is four times that, and not above
/// the one with which the board is known to run.
#[test]
fn over_current_is_a_short_and_nothing_less() {
    let ohm = 0.403 / 150.0;
    let (_, mv) = GATE_DRIVER.over_current_step();
    let most_mv = 1e3 * ohm * 1.3 * f64::from(MOTOR.sensors.trip_a);
    assert!((4.0 * most_mv..=403.0).contains(&f64::from(mv)), "{mv} mV, {most_mv} mV at most");
}

/// Situation: control stops. Must hold: the bridge opens after the largest gap that control permits between two
/// periods, counted in calls of the motor loop.
#[test]
fn the_timeout_is_that_of_control() {
    let ms = 1e3 * f32::from(COMMAND_TIMEOUT_CALLS) / MOTOR.rate_hz;
    assert_eq!(Some(ms), control::Config::product().input.max_gap_ms);
}

/// Situation: the fastest wheel that control accepts. Must hold: its pulses are more than one control period apart,
/// as the board sees at most one per period.
#[test]
fn pulses_are_apart() {
    let wheel = wheel();
    let distance_m = core::f32::consts::TAU * wheel.radius_m / f32::from(wheel.pulses_per_turn);
    let apart_ms =
        1e3 * distance_m * (1.0 - wheel.spacing_error) / control::Config::product().input.front_wheel.max;
    assert!((2.0..10.0).contains(&apart_ms), "{apart_ms} ms");
}
