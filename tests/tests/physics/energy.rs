//! Energy: constant without torque; with torques, changed by exactly their power.

use proptest::prop_assert;
use sim_host::bicycle::{Geometry, Motion, State, front_contact_residual};
use std::cell::Cell;
use tests::draws::{runner, situations};
use tests::flow;
use tests::rides::{FREE, knocked, ride, shipped};

/// Result of a ride.
struct Extremes {
    /// Largest change of energy, relative to the energy above upright rest.
    drift: f64,
    /// Largest height of the front wheel's lowest point above or below the ground \[m\].
    residual: f64,
    /// Largest roll and steer angle \[rad\].
    roll: f64,
    steer: f64,
    /// Smallest and largest forward speed \[m/s\].
    speed: [f64; 2],
}

/// Rides a knocked bicycle.
fn extremes(name: &str, v: f64, steer_rate: f64, step: f64, seconds: f64) -> Extremes {
    let b = Geometry::new(&shipped(name).parameters);
    let energy = |state: &State<f64>| Motion::new(&b, state).energy(&b, state);
    let start = knocked(&b, v, steer_rate);
    let (e0, above) = (energy(&start), energy(&start) - energy(&State::upright(&b, 0.0)));
    let mut found = Extremes { drift: 0.0, residual: 0.0, roll: 0.0, steer: 0.0, speed: [v, v] };
    ride(&b, start, &FREE, step, (seconds / step).round() as usize, |s| {
        let pitch = Motion::new(&b, s).pose.attitude.pitch;
        let residual = front_contact_residual(&b, s.roll, s.steer, pitch).abs();
        let speed = -s.rear_wheel_rate * b.rR;
        found.drift = found.drift.max((energy(s) - e0).abs() / above);
        found.residual = found.residual.max(residual);
        found.roll = found.roll.max(s.roll.abs());
        found.steer = found.steer.max(s.steer.abs());
        found.speed = [found.speed[0].min(speed), found.speed[1].max(speed)];
    });
    println!(
        "{name} {v} m/s, {steer_rate} rad/s, {step} s: drift {:.1e}, contact {:.1e} m, roll {:.1} deg, steer {:.1} deg, speed {:.2}..{:.2} m/s",
        found.drift,
        found.residual,
        found.roll.to_degrees(),
        found.steer.to_degrees(),
        found.speed[0],
        found.speed[1]
    );
    found
}

#[test]
fn benchmark_knocked_at_5_m_s_keeps_its_energy_for_a_minute() {
    let found = extremes("benchmark", 5.0, 2.0, 1e-3, 60.0);
    assert!(found.drift < 1e-10 && found.residual < 1e-14);
    // It rode on, and well away from the straight ride.
    assert!((0.15..0.35).contains(&found.roll) && (0.1..0.3).contains(&found.steer));
    assert!(found.speed[0] > 4.9 && found.speed[1] < 5.5 && found.speed[1] > 5.1);
}

#[test]
fn thesis_bicycle_knocked_hard_at_8_m_s_keeps_its_energy_for_a_minute() {
    let found = extremes("rigid_jason", 8.0, 5.0, 1e-3, 60.0);
    assert!(found.drift < 2e-10 && found.residual < 1e-14);
    assert!((0.4..0.6).contains(&found.roll) && (0.1..0.2).contains(&found.steer));
    assert!(found.speed[0] > 7.8 && found.speed[1] < 9.0 && found.speed[1] > 8.5);
}

/// The drift is the integrator's: it shrinks with the step.
#[test]
fn half_the_step_drifts_at_least_eight_times_less() {
    let [whole, half] = [2e-3, 1e-3].map(|step| extremes("rigid_jason", 8.0, 5.0, step, 10.0).drift);
    assert!(whole > 8.0 * half && whole < 64.0 * half, "{whole:e} {half:e}");
}

/// Any state, any torques: the energy's exact rate is the torques' power, and the energy is the sum over the four
/// bodies.
#[test]
fn energy_changes_by_the_power_of_the_torques() {
    let worst = Cell::new([0.0_f64; 2]);
    let strongest = Cell::new(0.0_f64);
    runner(1000)
        .run(&situations(60_f64.to_radians()), |d| {
            let (state, motion) = flow::along(&d.geometry, &d.state, &d.torques);
            let energy = motion.energy(&d.geometry, &state);
            let power = d.torques.roll * d.state.roll_rate + d.torques.steer * d.state.steer_rate;
            let bodies = newton_euler::solve(&d.parameters, &d.state, &d.torques).unwrap().energy;
            let off = [(energy.eps - power).abs() / power.abs().max(1e3), (energy.re / bodies - 1.0).abs()];
            worst.set([worst.get()[0].max(off[0]), worst.get()[1].max(off[1])]);
            strongest.set(strongest.get().max(power.abs()));
            prop_assert!(off[0] < 1e-10 && off[1] < 1e-12, "{}: {off:?}", d.name);
            Ok(())
        })
        .unwrap();
    let [rate, energy] = worst.get();
    println!("rate of energy {rate:.1e} of 1 kW, energy {energy:.1e}, power up to {:.0} W", strongest.get());
    assert!(strongest.get() > 100.0);
}
