//! The simulator's equations beside Newton's and Euler's for each body.

use sim_host::bicycle::{Geometry, State};
use std::cell::Cell;
use tests::draws::{Draw, runner, situations};
use tests::published::entry;
use tests::rides::{FREE, shipped};
use tests::{flow, newton_euler};

/// Largest of the differences of all rates or accelerations, relative to their own size.
fn relative(pairs: &[(f64, f64)]) -> f64 {
    let size = pairs.iter().map(|p| p.1.abs()).fold(1.0, f64::max);
    pairs.iter().map(|p| (p.0 - p.1).abs()).fold(0.0, f64::max) / size
}

/// Relative differences of rates and of accelerations, and the pitch's.
fn differences(draw: &Draw) -> Option<[f64; 3]> {
    let s = newton_euler::solve(&draw.parameters, &draw.state, &draw.torques)?;
    let (state, motion) = flow::along(&draw.geometry, &draw.state, &draw.torques);
    let v = motion.actual;
    let axle = flow::rear_axle_velocity(&draw.geometry, &state, &motion);
    let rates = [(v.pitch.re, s.pitch_rate), (v.yaw.re, s.yaw_rate), (v.front_spin.re, s.front_wheel_rate)];
    let accelerations = [
        (state.roll_rate.eps, s.roll_acceleration),
        (state.steer_rate.eps, s.steer_acceleration),
        (state.rear_wheel_rate.eps, s.rear_wheel_acceleration),
        (v.pitch.eps, s.pitch_acceleration),
        (v.yaw.eps, s.yaw_acceleration),
        (v.front_spin.eps, s.front_wheel_acceleration),
        (axle[0].eps, s.rear_axle_acceleration.x),
        (axle[1].eps, s.rear_axle_acceleration.y),
        (axle[2].eps, s.rear_axle_acceleration.z),
    ];
    Some([(draw.state.pitch - s.pitch).abs(), relative(&rates), relative(&accelerations)])
}

#[test]
fn a_thousand_random_states_of_all_bicycles_accelerate_alike() {
    let worst = Cell::new([0.0_f64; 3]);
    let seen = Cell::new(0);
    runner(1000)
        .run(&situations(60_f64.to_radians()), |draw| {
            let found = differences(&draw).expect("the front wheel reaches the ground");
            let w = worst.get();
            worst.set([w[0].max(found[0]), w[1].max(found[1]), w[2].max(found[2])]);
            seen.set(seen.get() + 1);
            proptest::prop_assert!(found.iter().all(|d| *d < 1e-10), "{:?} {found:?}", draw.name);
            Ok(())
        })
        .unwrap();
    let [pitch, rates, accelerations] = worst.get();
    println!(
        "{} states: pitch {pitch:.1e} rad, rates {rates:.1e}, accelerations {accelerations:.1e}",
        seen.get()
    );
    assert_eq!(seen.get(), 1000);
}

#[test]
fn wheel_loads_at_rest_match_the_published_ones_and_carry_the_weight() {
    let loads = entry("symbrim_normal_forces");
    let p = shipped(loads.text("bicycle")).parameters;
    let s = newton_euler::solve(&p, &State::upright(&Geometry::new(&p), 0.0), &FREE).unwrap();
    let (rear, front) = (-s.rear_contact.z, -s.front_contact.z);
    println!("rear {rear:.12} N, front {front:.12} N");
    assert!((rear - loads.number("rear")).abs() < loads.tolerance());
    assert!((front - loads.number("front")).abs() < loads.tolerance());
    let weight = (p.mR + p.mB + p.mH + p.mF) * p.g;
    assert!((rear + front - weight).abs() < loads.tolerance());
    let sideways = s.rear_contact.xy().norm() + s.front_contact.xy().norm();
    assert!(sideways < loads.tolerance(), "{sideways:e} N along the ground");
}
