//! Exact time derivatives: the state as dual numbers along the equations of motion.

use sim_host::bicycle::{Accelerations, Geometry, Motion, State, Torques};
use sim_host::integrate::rate;
use sim_host::num::Dual;

/// The state with its time derivative, and all quantities that follow from it, likewise.
pub fn along(b: &Geometry, state: &State<f64>, torques: &Torques<f64>) -> (State<Dual>, Motion<Dual>) {
    let motion = Motion::new(b, state);
    accelerated(b, state, &motion, &motion.accelerations(b, torques))
}

/// The same from the accelerations.
pub fn accelerated(
    b: &Geometry,
    state: &State<f64>,
    motion: &Motion<f64>,
    accelerations: &Accelerations<f64>,
) -> (State<Dual>, Motion<Dual>) {
    let rate = rate(state, motion, accelerations);
    let dual = |re, eps| Dual { re, eps };
    let moving = State {
        roll: dual(state.roll, rate.roll),
        steer: dual(state.steer, rate.steer),
        roll_rate: dual(state.roll_rate, rate.roll_rate),
        steer_rate: dual(state.steer_rate, rate.steer_rate),
        rear_wheel_rate: dual(state.rear_wheel_rate, rate.rear_wheel_rate),
        pitch: dual(state.pitch, rate.pitch),
    };
    let motion = Motion::new(b, &moving);
    (moving, motion)
}

/// Velocity of the rear wheel's centre in ground axes \[m/s\] (x along the heading of the moment, y
/// right, z down), and its acceleration as the derivative \[m/s^2\].
pub fn rear_axle_velocity(b: &Geometry, state: &State<Dual>, motion: &Motion<Dual>) -> [Dual; 3] {
    let v = motion.actual;
    let (sin_yaw, cos_yaw) = (Dual { re: 0.0, eps: v.yaw.re }, Dual { re: 1.0, eps: 0.0 });
    let (sin_roll, cos_roll) = motion.pose.attitude.roll;
    let forward = v.rolling * -b.rR;
    let along_axle = state.roll_rate * b.rR;
    let sideways = along_axle * cos_roll;
    [cos_yaw * forward - sin_yaw * sideways, sin_yaw * forward + cos_yaw * sideways, along_axle * sin_roll]
}
