//! Angles, transforms, modulation.

use motor::angle::Angle;
use motor::current::{self, CurrentState, Gains};
use motor::example::EXAMPLE;
use motor::modulate::duties;
use motor::transform::{Vector, clarke, park, phases, stator};
use proptest::prelude::*;

proptest! {
    /// Situation: any angle. Must hold: sine and cosine within 4e-7; those of the negative angle are mirrored to the
    /// bit.
    #[test]
    fn sine_and_cosine_of_any_turn(parts in any::<u32>()) {
        let (sin, cos) = Angle(parts).sin_cos();
        let rad = f64::from(parts) / 4_294_967_296.0 * std::f64::consts::TAU;
        prop_assert!((f64::from(sin) - rad.sin()).abs() < 4e-7 && (f64::from(cos) - rad.cos()).abs() < 4e-7);
        // Half a turn is its own mirror.
        if parts != 1 << 31 {
            let (mirrored_sin, mirrored_cos) = Angle(parts).mirrored().sin_cos();
            prop_assert_eq!((mirrored_sin, mirrored_cos), (-sin, cos));
        }
    }

    /// Situation: any three currents, any angle. Must hold: transform and inverse give the same currents less their
    /// mean, and the length is preserved.
    #[test]
    fn there_and_back(abc in prop::array::uniform3(-20.0_f32..20.0), parts in any::<u32>()) {
        let at = Angle(parts).sin_cos();
        let rotor = park(clarke(abc), at);
        let back = phases(stator(rotor, at));
        let mean = (abc[0] + abc[1] + abc[2]) / 3.0;
        for (there, back) in abc.iter().zip(back) {
            prop_assert!((there - mean - back).abs() < 2e-5, "{there} {mean} {back}");
        }
        prop_assert!((clarke(abc).length() - rotor.length()).abs() < 2e-5);
    }

    /// Situation: any voltage inside the bridge's reach. Must hold: the duty cycles give it exactly, and the largest
    /// and the smallest are equally far from the middle.
    #[test]
    fn the_duty_cycles_give_the_voltage(part in 0.0_f32..1.0, parts in any::<u32>(), bus_v in 16.0_f32..32.0) {
        let b = EXAMPLE.bridge;
        let (sin, cos) = Angle(parts).sin_cos();
        let requested = Vector::new(cos, sin).times(part * b.max_voltage_ratio() * bus_v);
        let d = duties(&b, 0.0, requested, Vector::default(), bus_v);
        let given = clarke(d.map(|d| d * bus_v));
        prop_assert!(given.minus(requested).length() < 1e-4 * bus_v, "{given:?} is not {requested:?}");
        let (most, least) = (d[0].max(d[1]).max(d[2]), d[0].min(d[1]).min(d[2]));
        prop_assert!((most + least - b.duty_max - b.duty_min).abs() < 1e-5);
    }
}

/// Situation: a voltage and a current too large for their circle. Must hold: d has priority as far as it fits, q
/// takes the rest, the length is the radius.
#[test]
fn the_circle_keeps_d() {
    let cut = |d, q| Vector::new(d, q).inside(5.0);
    assert_eq!(cut(3.0, 4.0), Vector::new(3.0, 4.0));
    assert!((cut(3.0, 9.0).q - 4.0).abs() < 1e-6 && cut(3.0, 9.0).d == 3.0);
    assert!((cut(3.0, -9.0).q + 4.0).abs() < 1e-6);
    assert_eq!(cut(-7.0, 1.0), Vector::new(-5.0, 0.0));
}

/// Situation: a winding at rest, on either axis; a set-point of 40 A, for which 5 V do not suffice, for 20 ms, then 2
/// A. Must hold: the voltage never beyond 5 V; within 0.2 A of 2 A after 30 calls, never below 1.85 A before: no
/// windup.
#[test]
fn neither_axis_winds_up() {
    let (r, l) = (EXAMPLE.motor.resistance_ohm, EXAMPLE.motor.inductance_d_h);
    let gains = Gains::new(&EXAMPLE.motor, &EXAMPLE.current, EXAMPLE.rate_hz);
    let keep = (-r / l / EXAMPLE.rate_hz).exp();
    for axis in [Vector::new(1.0, 0.0), Vector::new(0.0, 1.0)] {
        let (mut state, mut is) = (CurrentState::default(), Vector::default());
        let mut end = Vec::new();
        for call in 0..500 {
            let requested = axis.times(if call < 400 { 40.0 } else { 2.0 });
            let v = current::step(&gains, &mut state, requested, is, 0.0, 5.0);
            assert!(v.length() < 5.001);
            is = is.times(keep).plus(v.times((1.0 - keep) / r));
            end.push(is.length());
        }
        assert!((end[399] - 5.0 / r).abs() < 0.1, "{}", end[399]);
        assert!(end[430..].iter().all(|i| (i - 2.0).abs() < 0.2), "{axis:?}: {:?}", &end[400..440]);
        assert!(end[400..].iter().all(|i| *i > 1.85), "{axis:?}: {:?}", &end[400..440]);
    }
}
