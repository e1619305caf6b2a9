//! Flight cards: what a configuration may not be.

use motor::Config;
use motor::example::EXAMPLE;

type Change = fn(&mut Config);

fn refused(change: Change) -> String {
    let mut config = EXAMPLE;
    change(&mut config);
    config.plan().expect_err("must be refused").to_string()
}

/// Situation: one parameter is wrong, or does not go with another. Must hold: it is named, with its range.
#[test]
fn wrong_parameters_are_named() {
    assert!(EXAMPLE.plan().is_ok());
    let cases: [(Change, &str); 8] = [
        (|c| c.rate_hz = f32::NAN, "rate_hz = NaN is outside 5000 to 60000"),
        (|c| c.motor.flux_wb = 0.0, "motor.flux_wb = 0 is outside"),
        (|c| c.current.bandwidth_hz = 1700.0, "current.bandwidth_hz = 1700 is outside 10 to 1666"),
        (|c| c.align.current_a = 11.0, "align.current_a = 11 is outside 0.1 to 10"),
        (|c| c.sensors.trip_a = 11.0, "sensors.trip_a = 11 is outside 12 to 160"),
        (|c| c.supply.sag_v = 16.0, "supply.sag_v = 16 is outside"),
        (|c| c.heat.hot_c = 80.0, "heat.hot_c = 80 is outside 81 to 160"),
        (|c| c.encoder.jump_turns = 0.02, "encoder.jump_turns = 0.02 is outside 0.0001 to 0.015625"),
    ];
    for (change, told) in cases {
        let text = refused(change);
        assert!(text.starts_with(told), "{text}");
    }
}
