//! The lateral force on the rear frame: its linear model, its power, and the second formulation.

use nalgebra::Vector2;
use proptest::prelude::*;
use proptest::prop_assert;
use sim_host::bicycle::linear::Linear;
use sim_host::bicycle::{ForcePoint, Forces, Geometry, Motion, State};
use sim_host::num::Dual;
use std::cell::Cell;
use tests::draws::{Draw, runner, situations};
use tests::flow;
use tests::rides::{all_shipped, shipped};

const POINTS: [ForcePoint; 4] = [
    ForcePoint { ahead_m: 0.3, height_m: 0.9 },
    ForcePoint { ahead_m: -0.4, height_m: 0.0 },
    ForcePoint { ahead_m: 0.0, height_m: 1.2 },
    ForcePoint { ahead_m: 1.0, height_m: 0.5 },
];

/// Situation: every shipped bicycle upright and straight. Action: the exact derivative of its accelerations by the force.
/// Must hold: the inverse of the linear mass matrix times the linear input; no change of speed.
#[test]
fn a_small_force_accelerates_as_the_linear_input() {
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    let constant = |re| Dual { re, eps: 0.0 };
    for bicycle in all_shipped() {
        let (b, linear) = (Geometry::new(&bicycle.parameters), Linear::new(&bicycle.parameters));
        for (point, v) in POINTS.into_iter().zip([0.0, 2.0, 5.0, -3.0]) {
            let motion = Motion::new(&b, &State::upright(&b, constant(v)));
            let forces = motion.lateral_force(&b, point, Dual::variable(0.0));
            let found = motion.accelerations_under(&b, &forces);
            let expected = linear.m.try_inverse().expect("a regular mass matrix")
                * Vector2::from(linear.lateral_force_input(point));
            let off = (found.roll.eps - expected[0]).abs().max((found.steer.eps - expected[1]).abs());
            worst = worst.max(off / expected.norm());
            largest = largest.max(expected.norm());
            assert!(off < 1e-11 * expected.norm(), "{}, {point:?}: {off:e}", bicycle.name);
            assert_eq!(found.rear_wheel.eps, 0.0, "{}, {point:?}", bicycle.name);
        }
    }
    println!("accelerations differ by up to {worst:.1e} of their size, {largest:.3} rad/s^2 per N");
    assert!((0.01..10.0).contains(&largest));
}

/// Situation: the benchmark bicycle at rest and 5 m/s. Action: a force to the right, 1 m above the ground over the rear
/// contact, then on the ground ahead of it. Must hold: the first rolls it to the right; the second, which acts only as the
/// trail lets a steer rate turn the frame, is the smaller and pushes the steer to the right.
#[test]
fn a_force_to_the_right_has_the_sign_of_its_work() {
    let p = shipped("benchmark").parameters;
    let linear = Linear::new(&p);
    let above = linear.lateral_force_input(ForcePoint { ahead_m: 0.0, height_m: 1.0 });
    assert_eq!(above, [1.0, 0.0]);
    let ahead = linear.lateral_force_input(ForcePoint { ahead_m: p.w, height_m: 0.0 });
    assert_eq!(ahead[0], 0.0);
    assert!((ahead[1] - p.c * libm::cos(p.lam)).abs() < 1e-15 && ahead[1] > 0.0);
    let b = Geometry::new(&p);
    for v in [0.0, 5.0] {
        let motion = Motion::new(&b, &State::upright(&b, v));
        let push = motion.lateral_force(&b, ForcePoint { ahead_m: 0.0, height_m: 1.0 }, 10.0);
        assert!(motion.accelerations_under(&b, &push).roll > 0.0);
    }
}

/// A random situation, the point of a force and the force \[N\].
fn pushed() -> impl Strategy<Value = (Draw, ForcePoint, f64)> {
    let point = (-0.5..1.5, 0.0..1.5).prop_map(|(ahead_m, height_m)| ForcePoint { ahead_m, height_m });
    (situations(60_f64.to_radians()), point, -300.0..300.0)
}

/// Any state, torques and force: the energy's exact rate is the power of the torques and of the force.
#[test]
fn energy_changes_by_the_power_of_the_force() {
    let (worst, strongest) = (Cell::new(0.0_f64), Cell::new(0.0_f64));
    runner(1000)
        .run(&pushed(), |(d, point, force_n)| {
            let (b, motion) = (&d.geometry, Motion::new(&d.geometry, &d.state));
            let forces = motion.lateral_force(b, point, force_n).and(Forces::from(d.torques));
            let (state, moving) =
                flow::accelerated(b, &d.state, &motion, &motion.accelerations_under(b, &forces));
            let of_force = force_n * motion.lateral_velocity(b, point);
            let power = d.torques.roll * d.state.roll_rate + d.torques.steer * d.state.steer_rate + of_force;
            let off = (moving.energy(b, &state).eps - power).abs() / power.abs().max(1e3);
            worst.set(worst.get().max(off));
            strongest.set(strongest.get().max(of_force.abs()));
            prop_assert!(off < 1e-10, "{}: {off:e}", d.name);
            Ok(())
        })
        .unwrap();
    println!("rate of energy {:.1e} of 1 kW, power up to {:.0} W", worst.get(), strongest.get());
    assert!(strongest.get() > 300.0);
}

/// Any state, torques and force: the accelerations are those of Newton's and Euler's equations of the four bodies.
#[test]
fn a_pushed_bicycle_accelerates_as_newton_and_euler_say() {
    let (worst, share) = (Cell::new(0.0_f64), Cell::new(0.0_f64));
    runner(1000)
        .run(&pushed(), |(d, point, force_n)| {
            let (b, motion) = (&d.geometry, Motion::new(&d.geometry, &d.state));
            let forces = motion.lateral_force(b, point, force_n).and(Forces::from(d.torques));
            let (found, free) = (motion.accelerations_under(b, &forces), motion.accelerations(b, &d.torques));
            let s = newton_euler::solve_pushed(&d.parameters, &d.state, &d.torques, point, force_n)
                .expect("the front wheel reaches the ground");
            let pairs = [
                (found.roll, s.roll_acceleration),
                (found.steer, s.steer_acceleration),
                (found.rear_wheel, s.rear_wheel_acceleration),
            ];
            let size = pairs.iter().map(|p| p.1.abs()).fold(1.0, f64::max);
            let off = pairs.iter().map(|p| (p.0 - p.1).abs()).fold(0.0, f64::max) / size;
            worst.set(worst.get().max(off));
            share.set(share.get().max((found.roll - free.roll).abs() / size));
            prop_assert!(off < 1e-10, "{}: {off:e}", d.name);
            Ok(())
        })
        .unwrap();
    println!("accelerations {:.1e}, the force's part of them up to {:.2}", worst.get(), share.get());
    assert!(share.get() > 0.3);
}
