//! The integrator beside an adaptive solver of another library on the other formulation.

use differential_equations::prelude::*;
use sim_host::bicycle::{Geometry, Parameters, State, Torques};
use tests::newton_euler;
use tests::rides::{knocked, ride, shipped};

/// Newton's and Euler's equations as a system of first order in [`entries`].
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

#[test]
fn scan() {
    for (name, v, q, t) in [
        ("rigid_jason", 8.0, 5.0, 3.0),
        ("rigid_jason", 7.0, 7.0, 3.0),
        ("benchmark", 5.0, 4.0, 3.0),
        ("benchmark", 5.0, 5.0, 3.0),
        ("rigid_jason", 5.0, 3.0, 1.0),
    ] {
        let torques = Torques { roll: 0.0, steer: 0.0 };
        let parameters = shipped(name).parameters;
        let b = Geometry::new(&parameters);
        let start = knocked(&b, v, q);
        let reference = Reference { parameters, torques };
        let solution = IVP::ode(&reference, 0.0, t, entries(&start))
            .method(ExplicitRungeKutta::dop853().rtol(1e-13).atol(1e-13))
            .solve()
            .unwrap();
        let end = *solution.y.last().unwrap();
        println!(
            "{name} {v} {q}: {} evals {} steps {:?}",
            solution.evals.function,
            solution.steps.total(),
            end
        );
        let mut prev = 0.0;
        for step in [8e-3, 4e-3, 2e-3, 1e-3, 5e-4] {
            let mut m = [0.0_f64; 2];
            let e = ride(&b, start, &torques, step, (t / step).round() as usize, |s| {
                m = [m[0].max(s.roll.abs()), m[1].max(s.steer.abs())];
            });
            let off = entries(&e).iter().zip(&end).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            println!(
                "  {step}: {off:.2e} order {:.3} {:.1?}",
                (prev / off as f64).log2(),
                m.map(f64::to_degrees)
            );
            prev = off;
        }
    }
}
