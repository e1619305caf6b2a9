//! All velocities from the three independent speeds, by solving the rolling constraints.
//!
//! Vectors are in the steer-axis frame of [`Pose`]. Derivation: `docs/bicycle.md`, section 4.

use super::pitch::attitude;
use super::{Geometry, Pose, State};
use crate::num::{Scalar, Vec3};

/// One set of velocities: for one unit independent speed (a column of partial velocities), or the actual
/// ones.
#[derive(Clone, Copy, Debug)]
pub struct Velocities<S> {
    /// Roll rate \[rad/s\].
    pub roll: S,
    /// Pitch rate \[rad/s\].
    pub pitch: S,
    /// Yaw rate \[rad/s\].
    pub yaw: S,
    /// Steer rate \[rad/s\].
    pub steer: S,
    /// Rear wheel's rate relative to the rear frame \[rad/s\].
    pub rear_spin: S,
    /// Front wheel's rate relative to the front frame \[rad/s\].
    pub front_spin: S,
    /// Angular velocity of the rear frame.
    pub omega: Vec3<S>,
    /// Rear wheel's total rate about its axle \[rad/s\], which is its rolling rate.
    pub rolling: S,
}

impl<S: Scalar> Velocities<S> {
    /// Velocity of P, the rear wheel's centre; `e1` is the rear wheel's heading in [`Pose`].
    #[inline(always)]
    pub fn axle(&self, b: &Geometry, e1: Vec3<S>) -> Vec3<S> {
        let v = self.rolling * -b.rR;
        Vec3::new(e1.x * v, self.roll * b.rR, e1.z * v)
    }
}

/// Divisors and coupling terms of the three constraints at the front contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact<S> {
    /// `-1 / k . (u2 x base)`.
    per_pitch: S,
    /// `1 / lateral . (k x base)`.
    per_yaw: S,
    /// `lateral . (u2 x base)`, `heading . (u2 x base)`, `heading . (k x base)`.
    couplings: [S; 3],
}

impl<S: Scalar> Contact<S> {
    #[inline(always)]
    fn new(pose: &Pose<S>) -> Self {
        let l = pose.base;
        let one = S::constant(1.0);
        Self {
            per_pitch: -(one / u2_cross(l, pose.k)),
            per_yaw: one / l.dot(pose.heading),
            couplings: [
                u2_cross(l, pose.lateral),
                u2_cross(l, pose.heading),
                pose.heading.dot(pose.k.cross(l)),
            ],
        }
    }

    /// Pitch, yaw and front wheel rates (or accelerations) that cancel `free`: the velocity (or acceleration)
    /// of the material point at the front contact without them.
    ///
    /// Solved in sequence: only pitch moves the point vertically, only pitch and yaw laterally.
    #[inline(always)]
    pub(super) fn close(&self, b: &Geometry, pose: &Pose<S>, free: Vec3<S>) -> [S; 3] {
        let pitch = pose.k.dot(free) * self.per_pitch;
        let yaw = -((pose.lateral.dot(free) + pitch * self.couplings[0]) * self.per_yaw);
        let rolling = pose.heading.dot(free) + pitch * self.couplings[1] + yaw * self.couplings[2];
        [pitch, yaw, rolling * (-1.0 / b.rF)]
    }
}

/// `a . (u2 x l)`.
#[inline(always)]
fn u2_cross<S: Scalar>(l: Vec3<S>, a: Vec3<S>) -> S {
    a.x * l.z - a.z * l.x
}

/// Pose and velocities of a state.
#[derive(Clone, Copy, Debug)]
pub struct Motion<S> {
    /// The pose.
    pub pose: Pose<S>,
    /// Partial velocities: of unit roll rate, unit steer rate and unit rear wheel rate.
    pub partial: [Velocities<S>; 3],
    /// The actual velocities.
    pub actual: Velocities<S>,
    pub(super) contact: Contact<S>,
}

impl<S: Scalar> Motion<S> {
    /// Distance of the front contact ahead of the rear contact along the rear wheel's heading, as a fraction
    /// of the wheelbase: 1 when upright. At 0 the bicycle has folded sideways: roll and steer are at rest and
    /// only pitch moves.
    #[inline(always)]
    pub fn unfolded(&self, b: &Geometry) -> S {
        (self.pose.e1.x * self.pose.base.x + self.pose.e1.z * self.pose.base.z) * (1.0 / b.w)
    }

    /// Projection of the wheelbase on the front wheel's heading, as a fraction of the wheelbase: 1 when
    /// straight. At 0 the front wheel is across the path, where it can't roll.
    #[inline(always)]
    pub fn along_front(&self, b: &Geometry) -> S {
        self.pose.base.dot(self.pose.heading) * (1.0 / b.w)
    }

    /// Solves the constraints for a state. Pitch follows from the front contact's height; pitch rate, yaw
    /// rate and front wheel rate follow from rolling without slip: `omega x base - rR rear_spin e1 +
    /// steer_rate (u3 x trail) + rF front_spin heading = 0`.
    #[inline(always)]
    pub fn new(b: &Geometry, state: &State<S>) -> Self {
        let pose = Pose::new(b, attitude(b, state.roll, state.steer, state.pitch));
        let contact = Contact::new(&pose);
        let (k, e1, l) = (pose.k, pose.e1, pose.base);
        let (zero, one) = (S::constant(0.0), S::constant(1.0));

        let e1_l = Vec3::new(-(e1.z * l.y), e1.z * l.x - e1.x * l.z, e1.x * l.y);
        let [pitch, yaw, front_spin] = contact.close(b, &pose, e1_l);
        let omega = Vec3::new(e1.x + yaw * k.x, pitch + yaw * k.y, e1.z + yaw * k.z);
        let by_roll = Velocities {
            roll: one,
            pitch,
            yaw,
            steer: zero,
            rear_spin: zero,
            front_spin,
            omega,
            rolling: omega.y,
        };

        let [pitch, yaw, front_spin] = contact.close(b, &pose, Vec3::new(-pose.trail.y, pose.trail.x, zero));
        let omega = Vec3::new(yaw * k.x, pitch + yaw * k.y, yaw * k.z);
        let by_steer = Velocities {
            roll: zero,
            pitch,
            yaw,
            steer: one,
            rear_spin: zero,
            front_spin,
            omega,
            rolling: omega.y,
        };

        let [_, yaw, front_spin] = contact.close(b, &pose, e1.scaled(-b.rR));
        let omega = k.times(yaw);
        let by_wheel = Velocities {
            roll: zero,
            pitch: zero,
            yaw,
            steer: zero,
            rear_spin: one,
            front_spin,
            omega,
            rolling: omega.y + 1.0,
        };

        let (p, q, r) = (state.roll_rate, state.steer_rate, state.rear_wheel_rate);
        let omega = by_roll.omega.times(p) + by_steer.omega.times(q) + by_wheel.omega.times(r);
        let actual = Velocities {
            roll: p,
            pitch: by_roll.pitch * p + by_steer.pitch * q,
            yaw: by_roll.yaw * p + by_steer.yaw * q + by_wheel.yaw * r,
            steer: q,
            rear_spin: r,
            front_spin: by_roll.front_spin * p + by_steer.front_spin * q + by_wheel.front_spin * r,
            omega,
            rolling: omega.y + r,
        };
        Self { pose, partial: [by_roll, by_steer, by_wheel], actual, contact }
    }
}
