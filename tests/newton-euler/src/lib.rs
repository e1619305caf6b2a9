//! A second formulation of the bicycle, to verify the simulator.
//!
//! Newton's and Euler's equations of each of the four bodies, in ground axes, with every joint and contact force as
//! an unknown: 24 accelerations and 21 constraint forces from one linear system. It shares only the parameters and
//! the state with the simulator; the state's pitch is not read but solved for.

mod bodies;
mod constraints;

use bodies::{Bicycle, Body, FRONT_FRAME, FRONT_WHEEL, REAR_FRAME, REAR_WHEEL};
use constraints::{COLUMNS, CONTACT_ROWS, ROWS, angular, jacobian, rates};
use motion::bicycle::{ForcePoint, Parameters, State, Torques};
use nalgebra::{DMatrix, DVector, Vector3};

/// Everything about one state: rates, accelerations, contact forces. Ground axes have x along the
/// rear wheel's heading, y right, z down; angles and their signs are those of the simulator.
#[derive(Clone, Debug)]
pub struct Solution {
    /// Pitch \[rad\].
    pub pitch: f64,
    /// Pitch rate \[rad/s\].
    pub pitch_rate: f64,
    /// Yaw rate \[rad/s\].
    pub yaw_rate: f64,
    /// Front wheel's rate relative to the front frame \[rad/s\].
    pub front_wheel_rate: f64,
    /// Roll acceleration \[rad/s^2\].
    pub roll_acceleration: f64,
    /// Steer acceleration \[rad/s^2\].
    pub steer_acceleration: f64,
    /// Rear wheel's acceleration relative to the rear frame \[rad/s^2\].
    pub rear_wheel_acceleration: f64,
    /// Pitch acceleration \[rad/s^2\].
    pub pitch_acceleration: f64,
    /// Yaw acceleration \[rad/s^2\].
    pub yaw_acceleration: f64,
    /// Front wheel's acceleration relative to the front frame \[rad/s^2\].
    pub front_wheel_acceleration: f64,
    /// Position of the rear wheel's centre, from the rear contact \[m\].
    pub rear_axle: Vector3<f64>,
    /// Its velocity \[m/s\].
    pub rear_axle_velocity: Vector3<f64>,
    /// Position of the front contact, from the rear one \[m\].
    pub front_contact_place: Vector3<f64>,
    /// Acceleration of the rear wheel's centre \[m/s^2\].
    pub rear_axle_acceleration: Vector3<f64>,
    /// Kinetic and potential energy \[J\], the potential zero at ground height.
    pub energy: f64,
    /// Force of the ground on the rear wheel \[N\]; z is negative when it pushes up.
    pub rear_contact: Vector3<f64>,
    /// Force of the ground on the front wheel \[N\].
    pub front_contact: Vector3<f64>,
}

/// Solves one state; `None` if the front wheel cannot be put on the ground.
pub fn solve(p: &Parameters, state: &State<f64>, torques: &Torques<f64>) -> Option<Solution> {
    solve_pushed(p, state, torques, ForcePoint { ahead_m: 0.0, height_m: 0.0 }, 0.0)
}

/// The same with a lateral force \[N\] on a point of the rear frame, across the rear wheel's heading, to the right
/// positive.
pub fn solve_pushed(
    p: &Parameters,
    state: &State<f64>,
    torques: &Torques<f64>,
    point: ForcePoint,
    force_n: f64,
) -> Option<Solution> {
    let bicycle = Bicycle::on_ground(p, state.roll, state.steer)?;
    let j = jacobian(&bicycle);
    let v = velocities(&bicycle, &j, state)?;
    let push = Push { arm: bicycle.arm_on_rear_frame(p, point), force: Vector3::y() * force_n };
    let (a, force) = accelerations(&bicycle, &j, &v, p.g, torques, &push)?;

    let axle = bicycle.contacts[0].axle;
    let wheel = |x: &DVector<f64>, frame, wheel, axle: &Vector3<f64>| {
        axle.dot(&(angular(x, wheel) - angular(x, frame)))
    };
    let front_axle = bicycle.contacts[1].axle;

    // The rear frame turns by yaw about z, roll about x, pitch about the axle.
    let (sr, cr) = state.roll.sin_cos();
    let omega = angular(&v, REAR_FRAME);
    let pitch_rate = omega.y / cr;
    let yaw_rate = omega.z - pitch_rate * sr;
    let yaw_and_roll = Vector3::new(state.roll_rate, 0.0, yaw_rate);
    let turning = Vector3::z().cross(&Vector3::x()) * (yaw_rate * state.roll_rate)
        + yaw_and_roll.cross(&axle) * pitch_rate;
    let alpha = angular(&a, REAR_FRAME) - turning;
    let pitch_acceleration = alpha.y / cr;

    let contact = |i: usize| force.fixed_rows::<3>(CONTACT_ROWS + 3 * i).into_owned();
    Some(Solution {
        pitch: bicycle.pitch,
        pitch_rate,
        yaw_rate,
        front_wheel_rate: wheel(&v, FRONT_FRAME, FRONT_WHEEL, &front_axle),
        roll_acceleration: alpha.x,
        steer_acceleration: wheel(&a, REAR_FRAME, FRONT_FRAME, &bicycle.hinges[1].axis),
        rear_wheel_acceleration: wheel(&a, REAR_FRAME, REAR_WHEEL, &axle),
        pitch_acceleration,
        yaw_acceleration: alpha.z - pitch_acceleration * sr,
        front_wheel_acceleration: wheel(&a, FRONT_FRAME, FRONT_WHEEL, &front_axle),
        rear_axle: bicycle.bodies[REAR_WHEEL].centre,
        rear_axle_velocity: v.fixed_rows::<3>(6 * REAR_WHEEL).into_owned(),
        front_contact_place: bicycle.bodies[FRONT_WHEEL].centre + bicycle.contacts[1].arm(),
        rear_axle_acceleration: a.fixed_rows::<3>(6 * REAR_WHEEL).into_owned(),
        energy: energy(&bicycle, &v, p.g),
        rear_contact: contact(0),
        front_contact: contact(1),
    })
}

/// All velocities: the constraints, and the three rates that the state prescribes.
fn velocities(bicycle: &Bicycle, j: &DMatrix<f64>, state: &State<f64>) -> Option<DVector<f64>> {
    let mut matrix = j.clone().insert_rows(ROWS, 3, 0.0);
    let mut prescribe = |row: usize, body: usize, direction: &Vector3<f64>, sign: f64| {
        for axis in 0..3 {
            matrix[(ROWS + row, 6 * body + 3 + axis)] = sign * direction[axis];
        }
    };
    let (axle, head) = (&bicycle.contacts[0].axle, &bicycle.hinges[1].axis);
    prescribe(0, REAR_FRAME, &Vector3::x(), 1.0);
    prescribe(1, FRONT_FRAME, head, 1.0);
    prescribe(1, REAR_FRAME, head, -1.0);
    prescribe(2, REAR_WHEEL, axle, 1.0);
    prescribe(2, REAR_FRAME, axle, -1.0);
    let mut right = DVector::zeros(COLUMNS);
    right[ROWS] = state.roll_rate;
    right[ROWS + 1] = state.steer_rate;
    right[ROWS + 2] = state.rear_wheel_rate;
    matrix.lu().solve(&right)
}

/// Kinetic and potential energy of the four bodies.
fn energy(bicycle: &Bicycle, velocities: &DVector<f64>, gravity: f64) -> f64 {
    let one = |(i, body): (usize, &Body)| {
        let (v, omega) = (velocities.fixed_rows::<3>(6 * i), angular(velocities, i));
        0.5 * (body.mass * v.norm_squared() + omega.dot(&(body.inertia * omega)))
            - body.mass * gravity * body.centre.z
    };
    bicycle.bodies.iter().enumerate().map(one).sum()
}

/// A force on the rear frame.
struct Push {
    /// From the centre of mass to where it acts \[m\].
    arm: Vector3<f64>,
    force: Vector3<f64>,
}

/// Accelerations of the four bodies and the 21 constraint forces.
fn accelerations(
    bicycle: &Bicycle,
    j: &DMatrix<f64>,
    velocities: &DVector<f64>,
    gravity: f64,
    torques: &Torques<f64>,
    push: &Push,
) -> Option<(DVector<f64>, DVector<f64>)> {
    let mut matrix = DMatrix::zeros(COLUMNS + ROWS, COLUMNS + ROWS);
    let mut right = DVector::zeros(COLUMNS + ROWS);
    for (i, body) in bicycle.bodies.iter().enumerate() {
        let omega = angular(velocities, i);
        matrix.fixed_view_mut::<3, 3>(6 * i, 6 * i).fill_diagonal(body.mass);
        matrix.fixed_view_mut::<3, 3>(6 * i + 3, 6 * i + 3).copy_from(&body.inertia);
        right[6 * i + 2] = body.mass * gravity;
        right.fixed_rows_mut::<3>(6 * i + 3).copy_from(&-omega.cross(&(body.inertia * omega)));
    }
    let mut on_frame = right.fixed_rows_mut::<3>(6 * REAR_FRAME);
    on_frame += push.force;
    let mut turn = |body: usize, moment: Vector3<f64>| {
        let mut rows = right.fixed_rows_mut::<3>(6 * body + 3);
        rows += moment;
    };
    let head = bicycle.hinges[1].axis;
    turn(REAR_FRAME, Vector3::x() * torques.roll - head * torques.steer + push.arm.cross(&push.force));
    turn(FRONT_FRAME, head * torques.steer);

    matrix.view_mut((0, COLUMNS), (COLUMNS, ROWS)).copy_from(&-j.transpose());
    matrix.view_mut((COLUMNS, 0), (ROWS, COLUMNS)).copy_from(j);
    right.rows_mut(COLUMNS, ROWS).copy_from(&-rates(bicycle, velocities));
    let x = matrix.lu().solve(&right)?;
    Some((x.rows(0, COLUMNS).into_owned(), x.rows(COLUMNS, ROWS).into_owned()))
}
