//! The gate driver is enabled only once the rotor is slow.

use crate::boards::{PRODUCT, log_has, powered};
use devices::vesc6::MOTOR;
use std::f64::consts::TAU;
use virtual_board::Bench;
use virtual_board::power::Axis;
use virtual_board::wiring::Wiring;

/// A board powered while the rotor is turned at this speed \[turns/s\].
fn turned(turns_s: f64) -> Bench {
    let mut wiring = Wiring::new();
    wiring.power.set_axis(Axis::Driven);
    wiring.power.drive(0.0, rate_rad_s(turns_s));
    powered(PRODUCT, wiring)
}

/// The steer rate at a speed of the rotor.
fn rate_rad_s(turns_s: f64) -> f64 {
    TAU * turns_s / f64::from(MOTOR.motor.ratio)
}

/// Runs for a time \[ms\], sampling each millisecond; returns when the gate driver was first enabled \[ms\].
fn enabled_ms(bench: &mut Bench, ms: u32) -> Option<f64> {
    (0..ms).find_map(|_| {
        bench.run_ms(1.0).unwrap();
        bench.with(|board| board.chip.wiring.gate_driver.is_enabled()).then(|| bench.now_ms())
    })
}

/// Situation: the rotor is turned at 40 turns/s, which lifts the terminals above 8.5 V, or at 25, which does not.
/// Action: power on; the first rotor continues to turn, the second for 200 ms, then at 25 turns/s.
/// Must hold: the first driver is never enabled, and the log reports the speed it waited for; the second is within 20
/// ms of the slowing down, the third within 40 ms of power-on, after ten slow readings a millisecond apart.
#[test]
fn a_fast_rotor_keeps_the_gate_driver_off() {
    let mut bench = turned(40.0);
    assert_eq!(enabled_ms(&mut bench, 700), None);
    let logged = bench.log().iter().find_map(|line| {
        line.text
            .strip_prefix("gate driver: left off, the motor turned at ")?
            .split(' ')
            .next()?
            .parse::<f64>()
            .ok()
    });
    assert!(logged.is_some_and(|turns_s| (39.5..40.5).contains(&turns_s)), "{:#?}", bench.log());
    assert!(!log_has(&bench, 0.0, "gate driver: good=true"));

    let mut bench = turned(40.0);
    assert_eq!(enabled_ms(&mut bench, 200), None);
    bench.with(|board| board.chip.wiring.power.drive(0.0, rate_rad_s(25.0)));
    let slow_ms = bench.now_ms();
    let enabled = enabled_ms(&mut bench, 20).expect("enabled once the rotor is slow");
    assert!((10.0..=20.0).contains(&(enabled - slow_ms)), "{enabled} ms, slow at {slow_ms} ms");
    bench.run_ms(30.0).unwrap();
    assert!(log_has(&bench, slow_ms, "gate driver: good=true"), "{:#?}", bench.log());

    let enabled = enabled_ms(&mut turned(25.0), 40).expect("enabled");
    assert!((10.0..=40.0).contains(&enabled), "{enabled} ms");
}
