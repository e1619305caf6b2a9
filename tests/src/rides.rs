//! Rides without a controller.

use sim_host::bicycle::{Geometry, State, Torques, catalogue};
use sim_host::integrate::rk4;

/// No torque.
pub const FREE: Torques<f64> = Torques { roll: 0.0, steer: 0.0 };

/// A shipped bicycle.
///
/// # Panics
/// If there is none of that name.
pub fn shipped(name: &str) -> catalogue::Bicycle {
    catalogue::load(name).unwrap_or_else(|e| panic!("{e}"))
}

/// Every shipped bicycle.
pub fn all_shipped() -> Vec<catalogue::Bicycle> {
    catalogue::shipped_names().iter().map(|name| shipped(name)).collect()
}

/// Upright and straight at `v` \[m/s\], with the steer rate `steer_rate`.
pub fn knocked(b: &Geometry, v: f64, steer_rate: f64) -> State<f64> {
    State { steer_rate, ..State::upright(b, v) }
}

/// Rides `steps` steps of `step` seconds; `observe` receives every state, the first and the last included.
pub fn ride(
    b: &Geometry,
    start: State<f64>,
    torques: &Torques<f64>,
    step: f64,
    steps: usize,
    mut observe: impl FnMut(&State<f64>),
) -> State<f64> {
    let mut state = start;
    observe(&state);
    for _ in 0..steps {
        state = rk4(b, &state, step, &mut { *torques });
        observe(&state);
    }
    state
}
