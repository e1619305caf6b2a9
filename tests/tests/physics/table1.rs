//! The strongly nonlinear state of Basu-Mandal et al. 2007, Table 1: nine second derivatives, from
//! the simulator's equations and from the tests' own.

use sim_host::bicycle::{Geometry, State};
use tests::flow;

use tests::published::{Published, entry};
use tests::rides::{FREE, shipped};

const NAMES: [&str; 9] =
    ["x_dd", "y_dd", "z_dd", "theta_dd", "psi_dd", "phi_dd", "psif_dd", "betar_dd", "betaf_dd"];

/// The table's state; the pitch is that of the table, not solved for.
fn state(table: &Published) -> State<f64> {
    use std::f64::consts::{FRAC_PI_2, PI};
    State {
        roll: FRAC_PI_2 - table.number("psi"),
        steer: -table.number("psif"),
        roll_rate: -table.number("psi_d"),
        steer_rate: -table.number("psif_d"),
        rear_wheel_rate: -table.number("betar_d"),
        pitch: PI - table.number("phi"),
    }
}

/// Prints every difference and returns the largest.
fn largest_difference(table: &Published, names: &[&str], computed: &[f64]) -> f64 {
    assert_eq!(names.len(), computed.len());
    let mut largest: f64 = 0.0;
    for (name, value) in names.iter().zip(computed) {
        let difference = (value - table.number(name)).abs();
        println!("{name:>9} {value:+.13} difference {difference:.1e}");
        largest = largest.max(difference);
    }
    largest
}

#[test]
fn dependent_coordinates_and_rates_follow_from_the_independent_ones() {
    let table = entry("basu_mandal_table1");
    let b = Geometry::new(&shipped(table.text("bicycle")).parameters);
    let (state, motion) = flow::along(&b, &state(&table), &FREE);
    let axle = flow::rear_axle_velocity(&b, &state, &motion);
    let v = motion.actual;
    let names = ["x_d", "y_d", "z_d", "theta_d", "phi_d", "betaf_d", "z", "phi"];
    let height = motion.pose.attitude.roll.1.re * b.rR;
    let computed = [
        -axle[0].re,
        axle[1].re,
        -axle[2].re,
        -v.yaw.re,
        -v.pitch.re,
        -v.front_spin.re,
        height,
        std::f64::consts::PI - motion.pose.attitude.pitch.re,
    ];
    assert!(largest_difference(&table, &names, &computed) < table.tolerance());
}

#[test]
fn nine_accelerations_of_the_simulator_match_table_1() {
    let table = entry("basu_mandal_table1");
    let b = Geometry::new(&shipped(table.text("bicycle")).parameters);
    let (state, motion) = flow::along(&b, &state(&table), &FREE);
    let axle = flow::rear_axle_velocity(&b, &state, &motion);
    let v = motion.actual;
    let computed = [
        -axle[0].eps,
        axle[1].eps,
        -axle[2].eps,
        -v.yaw.eps,
        -state.roll_rate.eps,
        -v.pitch.eps,
        -state.steer_rate.eps,
        -state.rear_wheel_rate.eps,
        -v.front_spin.eps,
    ];
    assert!(largest_difference(&table, &NAMES, &computed) < table.tolerance());
}

#[test]
fn nine_accelerations_of_newton_and_euler_match_table_1() {
    let table = entry("basu_mandal_table1");
    let parameters = shipped(table.text("bicycle")).parameters;
    let s = newton_euler::solve(&parameters, &state(&table), &FREE).unwrap();
    let computed = [
        -s.rear_axle_acceleration.x,
        s.rear_axle_acceleration.y,
        -s.rear_axle_acceleration.z,
        -s.yaw_acceleration,
        -s.roll_acceleration,
        -s.pitch_acceleration,
        -s.steer_acceleration,
        -s.rear_wheel_acceleration,
        -s.front_wheel_acceleration,
    ];
    assert!(largest_difference(&table, &NAMES, &computed) < table.tolerance());
}
