//! The simulator's equations compared with Newton's and Euler's for each body.

use sim_host::bicycle::{FullState, Geometry, Motion, State};
use std::cell::Cell;
use tests::draws::{Draw, runner, situations};
use tests::flow;
use tests::published::entry;
use tests::rides::{FREE, shipped};

/// Largest of the differences of all rates or accelerations, relative to their own size.
fn relative(pairs: &[(f64, f64)]) -> f64 {
    let size = pairs.iter().map(|p| p.1.abs()).fold(1.0, f64::max);
    pairs.iter().map(|p| (p.0 - p.1).abs()).fold(0.0, f64::max) / size
}

/// Differences between the two formulations.
struct Found {
    /// Pitch \[rad\], dependent rates and all accelerations relative to their size.
    off: [f64; 3],
    /// [rad/s^2]
    steer_acceleration: f64,
}

fn compare(draw: &Draw) -> Option<Found> {
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
    let off = [(draw.state.pitch - s.pitch).abs(), relative(&rates), relative(&accelerations)];
    Some(Found { off, steer_acceleration: s.steer_acceleration })
}

#[test]
fn a_thousand_random_states_of_all_bicycles_accelerate_alike() {
    let worst = Cell::new([0.0_f64; 3]);
    // Their number, the largest roll and steer, the largest steer acceleration.
    let extremes = Cell::new((0, [0.0_f64; 3]));
    runner(1000)
        .run(&situations(60_f64.to_radians()), |draw| {
            let found = compare(&draw).expect("the front wheel reaches the ground");
            let w = worst.get();
            worst.set([0, 1, 2].map(|i| w[i].max(found.off[i])));
            let (count, most) = extremes.get();
            let here = [draw.state.roll, draw.state.steer, found.steer_acceleration];
            extremes.set((count + 1, [0, 1, 2].map(|i| most[i].max(here[i].abs()))));
            proptest::prop_assert!(found.off.iter().all(|d| *d < 1e-11), "{}: {:?}", draw.name, found.off);
            Ok(())
        })
        .unwrap();
    let [pitch, rates, accelerations] = worst.get();
    let (count, [roll, steer, steer_acceleration]) = extremes.get();
    println!("{count} states: pitch {pitch:.1e} rad, rates {rates:.1e}, accelerations {accelerations:.1e}");
    println!(
        "roll to {roll:.3}, steer to {steer:.3} rad, steer acceleration to {steer_acceleration:.0} rad/s^2"
    );
    assert!(count == 1000 && roll > 1.0 && steer > 1.0 && steer_acceleration > 1000.0);
}

/// Situation: the same random states, with all six speeds as state.
/// Action: their accelerations.
/// Must hold: they are those of Newton's and Euler's equations, the dependent ones too.
#[test]
fn six_speeds_accelerate_alike() {
    let count = Cell::new(0);
    runner(1000)
        .run(&situations(80_f64.to_radians()), |draw| {
            let s = newton_euler::solve(&draw.parameters, &draw.state, &draw.torques)
                .expect("the wheel reaches the ground");
            let full = FullState::new(&Motion::new(&draw.geometry, &draw.state), &draw.state);
            let [roll, pitch, yaw, steer, rear, front] =
                full.rate(&draw.geometry, &draw.torques).expect("no singular configuration").speeds;
            let off = relative(&[
                (roll, s.roll_acceleration),
                (steer, s.steer_acceleration),
                (rear, s.rear_wheel_acceleration),
                (pitch, s.pitch_acceleration),
                (yaw, s.yaw_acceleration),
                (front, s.front_wheel_acceleration),
            ]);
            proptest::prop_assert!(off < 1e-10, "{}: {off:e}", draw.name);
            count.set(count.get() + 1);
            Ok(())
        })
        .unwrap();
    assert_eq!(count.get(), 1000);
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
