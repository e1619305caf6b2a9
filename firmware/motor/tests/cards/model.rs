//! The simulated machine agrees with calculations by hand.

use crate::machine::{Machine, Params};

fn plain() -> Params {
    Params { saturation_a: 1e9, dead_time_s: 0.0, coulomb_nm: 0.0, capacitor_f: 10.0, ..Params::default() }
}

/// Situation: a held rotor, one phase against the two others. Must hold: the current rises as 1 - exp(-t R/L)
/// towards U/R.
#[test]
fn the_winding_charges_as_a_coil() {
    let p = plain();
    let mut m = Machine { held: true, ..Machine::new(p) };
    let volts = 2.0;
    let duty = 0.5 + volts / m.bus_v;
    // Two thirds of the legs' difference lie along phase a.
    let end_a = 2.0 / 3.0 * volts / p.resistance_ohm;
    for tick in 1..=60 {
        m.advance(Some([duty, 0.5, 0.5]));
        let t = f64::from(tick) / p.rate_hz;
        let should = end_a * (1.0 - (-t * p.resistance_ohm / p.inductance_d_h).exp());
        let error = (m.phases_a()[0] - should).abs();
        assert!(error < 0.01 * end_a, "{tick}: {} is not {should}", m.phases_a()[0]);
    }
    assert!((m.torque_nm() - 0.0).abs() < 1e-9, "a current along d gives no torque: {}", m.torque_nm());
}

/// Situation: no bridge, the steer turned by a constant torque against viscous friction. Must hold: the steer
/// rate ends at torque over friction.
#[test]
fn the_steer_ends_at_torque_over_friction() {
    let p = plain();
    let mut m = Machine { load_nm: 1.0, ..Machine::new(p) };
    for _ in 0..(8.0 * p.inertia_kg_m2 / p.viscous_nm_s_rad * p.rate_hz) as usize {
        m.advance(None);
    }
    let should = 1.0 / p.viscous_nm_s_rad;
    assert!((m.steer_rate_rad_s / should - 1.0).abs() < 1e-3, "{} is not {should}", m.steer_rate_rad_s);
}

/// Situation: an open phase.
/// Must hold: it carries no current, the two others carry the same, opposed.
#[test]
fn an_open_phase_carries_no_current() {
    for cut in 0..3 {
        let mut m = Machine { held: true, motor_turns: 0.03, ..Machine::new(plain()) };
        m.cut[cut] = true;
        for _ in 0..20 {
            m.advance(Some([0.55, 0.48, 0.40]));
        }
        let i = m.phases_a();
        assert!(i[cut].abs() < 1e-9 && i[(cut + 1) % 3].abs() > 0.5, "{i:?}");
        assert!((i[(cut + 1) % 3] + i[(cut + 2) % 3]).abs() < 1e-9, "{i:?}");
    }
}
