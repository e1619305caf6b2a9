//! Detection of a rotor slow enough to enable the gate driver.

use devices::as5047::COUNTS;
use devices::rotor_speed::RotorSpeedCheck;
use devices::vesc6::{ENABLE_V, MOTOR};

/// The first millisecond of 500 in which a rotor of this speed counts as slow, from encoder counts.
fn slow_after_ms(turns_s: f64, most_turns_s: f32) -> Option<usize> {
    let mut slow = RotorSpeedCheck::default();
    (0..500).position(|ms| {
        let turn = (0.9 + 1e-3 * turns_s * f64::from(ms)).rem_euclid(1.0);
        slow.step(Some((turn * f64::from(COUNTS)) as u16), most_turns_s)
    })
}

/// Situation: rotors of any speed in both directions, across the encoder's zero. Must hold: those below the limit are
/// slow after 11 samples, those above it never.
#[test]
fn the_limit_separates_slow_from_fast() {
    for turns_s in [0.0, 0.2, 5.0, 28.0, 31.5] {
        assert_eq!(slow_after_ms(turns_s, 32.0), Some(10), "{turns_s}");
        assert_eq!(slow_after_ms(-turns_s, 32.0), Some(10), "-{turns_s}");
    }
    for turns_s in [32.5, 40.0, 100.0, 166.0, 400.0] {
        assert_eq!(slow_after_ms(turns_s, 32.0), None, "{turns_s}");
        assert_eq!(slow_after_ms(-turns_s, 32.0), None, "-{turns_s}");
    }
}

/// Situation: an encoder without samples, or with every other sample. Must hold: its rotor is never slow, and has no
/// speed.
#[test]
fn without_samples_the_rotor_is_not_slow() {
    let (mut silent, mut patchy) = (RotorSpeedCheck::default(), RotorSpeedCheck::default());
    for ms in 0..500 {
        assert!(!silent.step(None, 32.0) && !patchy.step((ms % 2 == 0).then_some(77), 32.0));
        assert_eq!((silent.turns_s, patchy.turns_s), (None, None));
    }
}

/// Situation: the board's motor turned by hand, the bridge open. Must hold: the terminals reach the gate driver's
/// limit at 5 to 6 rad/s of the handlebar, faster than in riding.
#[test]
fn the_limit_is_that_of_the_motor() {
    let turns_s = MOTOR.motor.turns_s_at(ENABLE_V);
    let handlebar_rad_s = std::f32::consts::TAU * turns_s / MOTOR.motor.ratio;
    assert!((5.4..5.7).contains(&handlebar_rad_s), "{handlebar_rad_s} rad/s");
}
