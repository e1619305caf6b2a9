//! The integrator compared with an adaptive solver of another library on the other formulation.

use differential_equations::prelude::*;
use sim_host::bicycle::{Geometry, Parameters, State, Torques};

use tests::rides::{FREE, knocked, ride, shipped};

/// Newton's and Euler's equations as a first-order system of [`entries`].
struct Reference {
    parameters: Parameters,
    torques: Torques<f64>,
}

impl ODE<f64, [f64; 5]> for Reference {
    fn diff(&self, _: f64, y: &[f64; 5], rate: &mut [f64; 5]) {
        let state = State {
            roll: y[0],
            steer: y[1],
            roll_rate: y[2],
            steer_rate: y[3],
            rear_wheel_rate: y[4],
            pitch: f64::NAN,
        };
        let s = newton_euler::solve(&self.parameters, &state, &self.torques).expect("wheels on the ground");
        *rate = [y[2], y[3], s.roll_acceleration, s.steer_acceleration, s.rear_wheel_acceleration];
    }
}

fn entries(s: &State<f64>) -> [f64; 5] {
    [s.roll, s.steer, s.roll_rate, s.steer_rate, s.rear_wheel_rate]
}

/// Differences of the end states of one ride in three steps, 2, 1 and 0.5 ms, from the reference.
fn errors(name: &str, start: [f64; 2], torques: Torques<f64>, seconds: f64) -> [f64; 3] {
    let parameters = shipped(name).parameters;
    let b = Geometry::new(&parameters);
    let start = knocked(&b, start[0], start[1]);
    // The longest step avoids trial steps from states in which the wheels cannot both be on the ground.
    let method = ExplicitRungeKutta::dop853().rtol(1e-13).atol(1e-13).h_max(0.02);
    let reference = Reference { parameters, torques };
    let solution = IVP::ode(&reference, 0.0, seconds, entries(&start)).method(method).solve().unwrap();
    let expected = solution.y.last().unwrap();

    let [mut roll, mut steer] = [0.0_f64; 2];
    let errors = [2e-3, 1e-3, 5e-4].map(|step| {
        let end = ride(&b, start, &torques, step, (seconds / step).round() as usize, |s| {
            (roll, steer) = (roll.max(s.roll.abs()), steer.max(s.steer.abs()));
        });
        entries(&end).iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    });
    let angles = [roll, steer].map(f64::to_degrees);
    println!("{name}: roll {:.1} deg, steer {:.1} deg", angles[0], angles[1]);
    println!(
        "    2, 1, 0.5 ms: {:.1e} {:.1e} {:.1e}, orders {:.3?}",
        errors[0],
        errors[1],
        errors[2],
        orders(errors)
    );
    errors
}

fn orders(e: [f64; 3]) -> [f64; 2] {
    [(e[0] / e[1]).log2(), (e[1] / e[2]).log2()]
}

/// Also bounded below: the reference is more exact than the tested ride.
fn assert_fourth_order(errors: [f64; 3], at_1_ms: std::ops::Range<f64>) {
    assert!(at_1_ms.contains(&errors[1]), "{errors:?}");
    for order in orders(errors) {
        assert!((3.8..4.2).contains(&order), "order {order}");
    }
}

#[test]
fn a_hard_knock_that_is_recovered_from() {
    assert_fourth_order(errors("rigid_jason", [8.0, 6.5], FREE, 3.0), 1e-10..5e-9);
}

#[test]
fn a_hard_knock_of_the_benchmark_under_torques() {
    let torques = Torques { roll: 8.0, steer: -0.3 };
    assert_fourth_order(errors("benchmark", [5.0, 5.0], torques, 3.0), 1e-11..5e-9);
}

/// The handlebar turns in at 7 rad/s, the bicycle rolls to 46 degrees.
#[test]
fn a_fall_with_the_front_wheel_folding_under() {
    assert_fourth_order(errors("rigid_jason", [4.0, 3.0], FREE, 0.8), 1e-8..1e-6);
}
