//! Rides without a controller.

use sim_host::bicycle::{Geometry, State, Torques, catalogue};
use sim_host::integrate::rk4;

/// No torque.
pub const FREE: Torques<f64> = Torques { roll: 0.0, steer: 0.0 };

/// A shipped bicycle.
///
/// # Panics
/// When none has that name.
pub fn shipped(name: &str) -> catalogue::Bicycle {
    catalogue::load(name).unwrap_or_else(|e| panic!("{e}"))
}

/// Every shipped bicycle.
pub fn all_shipped() -> Vec<catalogue::Bicycle> {
    catalogue::shipped_names().iter().map(|name| shipped(name)).collect()
}

/// Upright and straight at `v` \[m/s\], the handlebar knocked to turn at `steer_rate` \[rad/s\].
pub fn knocked(b: &Geometry, v: f64, steer_rate: f64) -> State<f64> {
    State { steer_rate, ..State::upright(b, v) }
}

/// Rides `steps` steps of `step` seconds; `watch` sees every state, the first and the last too.
pub fn ride(
    b: &Geometry,
    start: State<f64>,
    torques: &Torques<f64>,
    step: f64,
    steps: usize,
    mut watch: impl FnMut(&State<f64>),
) -> State<f64> {
    let mut state = start;
    watch(&state);
    for _ in 0..steps {
        state = rk4(b, &state, step, &mut { *torques });
        watch(&state);
    }
    state
}
