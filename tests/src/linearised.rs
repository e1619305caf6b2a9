//! The simulator's nonlinear equations linearised at upright riding, exactly, by dual numbers.

use nalgebra::Matrix2;
use sim_host::bicycle::{Geometry, Motion, State, Torques};
use sim_host::num::Dual;

/// `m q'' + damping q' + stiffness q = T` at one speed, `q = [roll, steer]`.
#[derive(Clone, Copy, Debug)]
pub struct Linearised {
    /// Mass matrix.
    pub m: Matrix2<f64>,
    /// Damping: `v C1`.
    pub damping: Matrix2<f64>,
    /// Stiffness: `g K0 + v^2 K2`.
    pub stiffness: Matrix2<f64>,
    /// Derivatives of the rear wheel's acceleration by roll, steer, their rates and torques: zero, as a mirrored
    /// deviation must have the same effect on the speed.
    pub speed: [f64; 6],
}

/// Linearises at forward speed `v` \[m/s\].
///
/// # Panics
/// If the mass matrix is singular.
pub fn linearise(b: &Geometry, v: f64) -> Linearised {
    let constant = |re| Dual { re, eps: 0.0 };
    let column = |input: usize| {
        let at = |i: usize| if i == input { Dual::variable(0.0) } else { constant(0.0) };
        let state = State {
            roll: at(0),
            steer: at(1),
            roll_rate: at(2),
            steer_rate: at(3),
            ..State::upright(b, constant(v))
        };
        let torques = Torques { roll: at(4), steer: at(5) };
        let a = Motion::new(b, &state).accelerations(b, &torques);
        [a.roll.eps, a.steer.eps, a.rear_wheel.eps]
    };
    let columns: [[f64; 3]; 6] = std::array::from_fn(column);
    let pair = |i: usize| Matrix2::new(columns[i][0], columns[i + 1][0], columns[i][1], columns[i + 1][1]);
    let m = pair(4).try_inverse().expect("a regular mass matrix");
    Linearised { m, damping: -m * pair(2), stiffness: -m * pair(0), speed: columns.map(|c| c[2]) }
}
