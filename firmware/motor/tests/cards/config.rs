//! Invalid configurations.

use motor::Config;
use motor::example::EXAMPLE;

type Change = fn(&mut Config);

fn error_of(change: Change) -> String {
    let mut config = EXAMPLE;
    change(&mut config);
    config.plan().expect_err("must be error_of").to_string()
}

/// Situation: one parameter is invalid, or inconsistent with another. Must hold: the error names it, with its range.
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
        (|c| c.temperature.hot_c = 80.0, "heat.hot_c = 80 is outside 81 to 160"),
        (|c| c.encoder.jump_turns = 0.02, "encoder.jump_turns = 0.02 is outside 0.0001 to 0.015625"),
    ];
    for (change, expected) in cases {
        let text = error_of(change);
        assert!(text.starts_with(expected), "{text}");
    }
}

/// Situation: an offset stored with the check value of its motor.
/// Action: change each parameter that affects the offset, alone; change those that do not.
/// Must hold: another value for each of the former, the same for the latter; the example's value is that in the
/// flash of boards.
#[test]
fn an_offset_belongs_to_a_motor_and_its_encoder() {
    let id = EXAMPLE.motor_id();
    let changes: [fn(&mut Config); 7] = [
        |c| c.motor.pole_pairs = 7,
        |c| c.motor.resistance_ohm *= 1.01,
        |c| c.motor.inductance_d_h *= 1.01,
        |c| c.motor.inductance_q_h *= 1.01,
        |c| c.motor.flux_wb *= 1.01,
        |c| c.encoder.counts = 4096,
        |c| c.encoder.reversed = true,
    ];
    let mut ids = vec![id];
    for change in changes {
        let mut config = EXAMPLE;
        change(&mut config);
        ids.push(config.motor_id());
    }
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), 8, "{ids:08x?}");
    let mut same = EXAMPLE;
    (same.motor.reversed, same.motor.ratio, same.encoder.offset_turns) = (true, 20.0, Some(0.1));
    same.demand.max_nm = 1.0;
    assert_eq!(same.motor_id(), id);
    assert_eq!(id, 0xe512_477e);
}
