//! The bicycle with all six speeds as state, and the constraint forces at the front contact as unknowns.
//!
//! Roll rate, steer rate and rear wheel rate determine the other speeds except at two singular
//! configurations: the front wheel across the path (the rear wheel can't roll), and the front wheel beside
//! the rear wheel (only pitch moves). The motion passes these smoothly. This formulation follows it, at ten
//! times the cost. `docs/bicycle.md`, section 9.

use super::inertia::{Inertia, Momenta};
use super::pitch::Attitude;
use super::{Geometry, Motion, Pose, State, Torques, Velocities};
use crate::num::{Moves, Vec3, sin_cos};

/// A state with redundant speeds, which satisfy the constraints.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FullState {
    /// Roll, pitch and steer \[rad\].
    pub angles: [f64; 3],
    /// Rates of roll, pitch, yaw, steer, rear wheel and front wheel \[rad/s\].
    pub speeds: [f64; 6],
}

impl FullState {
    /// The state with its dependent speeds, from a motion away from the singular configurations.
    pub fn new(motion: &Motion<f64>, state: &State<f64>) -> Self {
        let v = &motion.actual;
        Self {
            angles: [state.roll, motion.pose.attitude.pitch, state.steer],
            speeds: [v.roll, v.pitch, v.yaw, v.steer, v.rear_spin, v.front_spin],
        }
    }

    /// The independent state.
    pub fn state(&self) -> State<f64> {
        State {
            roll: self.angles[0],
            pitch: self.angles[1],
            steer: self.angles[2],
            roll_rate: self.speeds[0],
            steer_rate: self.speeds[3],
            rear_wheel_rate: self.speeds[4],
        }
    }

    /// The pose at the stored pitch.
    #[inline(always)]
    pub fn pose(&self, b: &Geometry) -> Pose<f64> {
        let [roll, pitch, steer] = self.angles;
        let tilt = sin_cos(pitch + b.lam);
        Pose::new(b, Attitude { roll: sin_cos(roll), steer: sin_cos(steer), tilt, pitch })
    }

    /// The velocities, with the stored dependent ones.
    #[inline(always)]
    pub fn velocities(&self, b: &Geometry) -> Velocities<f64> {
        velocities(&self.pose(b), &self.speeds)
    }

    /// Time derivative of every entry under `torques`, in the same fields. `None` if the equations are
    /// singular, which does not occur near a ride.
    #[inline(always)]
    pub fn rate(&self, b: &Geometry, torques: &Torques<f64>) -> Option<FullState> {
        let pose = self.pose(b);
        let unit: [Velocities<f64>; 6] = std::array::from_fn(|i| {
            let mut speeds = [0.0; 6];
            speeds[i] = 1.0;
            velocities(&pose, &speeds)
        });
        let actual = velocities(&pose, &self.speeds);
        let inertia = Inertia::new(b, &pose);
        let (bias, free) = super::bias::bias(b, &pose, &actual, &inertia, None);
        let [roll, pitch, yaw, steer, rear, front] = &unit;
        let momenta = [
            inertia.momenta::<true, false, false>(b, &pose, roll),
            inertia.momenta::<false, false, false>(b, &pose, pitch),
            inertia.momenta::<false, false, false>(b, &pose, yaw),
            inertia.momenta::<false, true, false>(b, &pose, steer),
            inertia.momenta::<false, false, true>(b, &pose, rear),
            inertia.momenta::<false, false, false>(b, &pose, front),
        ];
        let powers = |f: &Momenta<f64>| {
            [
                roll.power::<true, false, false>(b, &pose, f),
                pitch.power::<false, false, false>(b, &pose, f),
                yaw.power::<false, false, false>(b, &pose, f),
                steer.power::<false, true, false>(b, &pose, f),
                rear.power::<false, false, true>(b, &pose, f),
                front.power::<false, false, false>(b, &pose, f),
            ]
        };
        let mut equations: Equations = [[0.0; UNKNOWNS + 1]; UNKNOWNS];
        for (j, (unit, momenta)) in unit.iter().zip(&momenta).enumerate() {
            for (i, power) in powers(momenta).into_iter().enumerate().take(j + 1) {
                equations[i][j] = power;
                equations[j][i] = power;
            }
            let contact = contact_velocity(b, &pose, unit);
            for (i, c) in [contact.x, contact.y, contact.z].into_iter().enumerate() {
                equations[6 + i][j] = c;
                equations[j][6 + i] = c;
            }
        }
        let [mut p0, p1, p2, mut p3, p4, p5] = powers(&bias).map(|power| -power);
        p0 += torques.roll;
        p3 += torques.steer;
        let known = [p0, p1, p2, p3, p4, p5, -free.x, -free.y, -free.z];
        for (row, known) in equations.iter_mut().zip(known) {
            row[UNKNOWNS] = known;
        }
        let solution = solve(equations)?;
        let speeds = std::array::from_fn(|i| solution[i]);
        Some(FullState { angles: [actual.roll, actual.pitch, actual.steer], speeds })
    }
}

/// The derivatives of six speeds, and three constraint forces.
const UNKNOWNS: usize = 9;

/// Linear equations: in each row the coefficients, then the known side.
type Equations = [[f64; UNKNOWNS + 1]; UNKNOWNS];

/// Solves the equations by elimination; `None` if a pivot is zero.
///
/// No pivots are chosen. The part of the six speeds is a mass matrix, positive definite, and what its elimination leaves of the
/// constraint forces is negative definite, since the constraints are independent: in this order no pivot is zero.
#[inline(always)]
fn solve(mut rows: Equations) -> Option<[f64; UNKNOWNS]> {
    let per_pivot = [
        eliminate::<0>(&mut rows),
        eliminate::<1>(&mut rows),
        eliminate::<2>(&mut rows),
        eliminate::<3>(&mut rows),
        eliminate::<4>(&mut rows),
        eliminate::<5>(&mut rows),
        eliminate::<6>(&mut rows),
        eliminate::<7>(&mut rows),
        eliminate::<8>(&mut rows),
    ];
    let mut solution = rows.map(|row| row[UNKNOWNS]);
    for i in (0..UNKNOWNS).rev() {
        solution[i] *= per_pivot[i];
        for j in 0..UNKNOWNS {
            if j < i {
                solution[j] -= rows[j][i] * solution[i];
            }
        }
    }
    per_pivot.iter().all(|x| x.is_finite()).then_some(solution)
}

/// Eliminates the unknown `I` from the rows below. Returns the reciprocal of its pivot.
#[inline(always)]
fn eliminate<const I: usize>(rows: &mut Equations) -> f64 {
    let pivot = rows[I];
    let per_pivot = 1.0 / pivot[I];
    for row in &mut rows[I + 1..] {
        let part = row[I] * per_pivot;
        for j in I + 1..=UNKNOWNS {
            row[j] -= part * pivot[j];
        }
    }
    per_pivot
}

#[inline(always)]
fn velocities(
    pose: &Pose<f64>,
    &[roll, pitch, yaw, steer, rear_spin, front_spin]: &[f64; 6],
) -> Velocities<f64> {
    let mut omega = pose.e1.scaled(roll) + pose.k.scaled(yaw);
    omega.y += pitch;
    Velocities { roll, pitch, yaw, steer, rear_spin, front_spin, omega, rolling: omega.y + rear_spin }
}

impl Moves for FullState {
    fn moved(&self, h: f64, rate: &Self) -> Self {
        let mut to = *self;
        to.angles.iter_mut().zip(rate.angles).for_each(|(x, r)| *x += h * r);
        to.speeds.iter_mut().zip(rate.speeds).for_each(|(x, r)| *x += h * r);
        to
    }
}

/// Velocity of the material point at the front contact; the constraints make it zero.
#[inline(always)]
fn contact_velocity(b: &Geometry, pose: &Pose<f64>, v: &Velocities<f64>) -> Vec3<f64> {
    v.omega.cross(pose.base) - pose.e1.scaled(v.rear_spin * b.rR)
        + Vec3::new(-pose.trail.y, pose.trail.x, 0.0).scaled(v.steer)
        + pose.heading.scaled(v.front_spin * b.rF)
}
