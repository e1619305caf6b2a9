//! Generalised mass matrix, from the pose: momenta of the whole bicycle for each unit speed.
//!
//! The bicycle is one body that moves with the rear frame, plus the front frame's rotation about the steer
//! axis and the wheels' spins. `docs/bicycle.md`, section 5.

use super::{Geometry, Pose, Velocities};
use crate::num::{Scalar, Vec3};

/// A symmetric tensor: 11, 22, 33, 12, 13, 23.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tensor<S>([S; 6]);

impl<S: Scalar> Tensor<S> {
    #[inline(always)]
    pub(super) fn times(&self, v: Vec3<S>) -> Vec3<S> {
        let [a11, a22, a33, a12, a13, a23] = self.0;
        Vec3::new(
            a11 * v.x + a12 * v.y + a13 * v.z,
            a12 * v.x + a22 * v.y + a23 * v.z,
            a13 * v.x + a23 * v.y + a33 * v.z,
        )
    }
}

/// Mass properties at one pose, about P, in the steer-axis frame.
pub(super) struct Inertia<S> {
    /// The front gyrostat's inertia about its own centre of mass.
    pub(super) front: Tensor<S>,
    /// First moment of the whole bicycle \[kg m\].
    pub(super) moment: Vec3<S>,
    /// Inertia of the whole bicycle.
    whole: Tensor<S>,
    /// Momentum for a unit steer rate.
    steer_momentum: Vec3<S>,
    /// Angular momentum for a unit steer rate.
    steer_angular: Vec3<S>,
}

impl<S: Scalar> Inertia<S> {
    #[inline(always)]
    pub(super) fn new(b: &Geometry, pose: &Pose<S>) -> Self {
        let (sd, cd) = pose.attitude.steer;
        let [a, bb, c, d] = b.front.inertia;
        let s2 = sd * sd;
        // The front inertia tensor rotated by the steer angle about u3.
        let front = Tensor([
            s2 * (bb - a) + a,
            s2 * (a - bb) + bb,
            S::constant(c),
            sd * cd * (a - bb),
            cd * d,
            sd * d,
        ]);
        let r = pose.front_com;
        let mr = r.scaled(b.front.mass);
        let (xx, yy, zz) = (mr.x * r.x, mr.y * r.y, mr.z * r.z);
        let [r11, r22, r33, r13] = b.rear.about_origin;
        let f = front.0;
        let whole = Tensor([
            f[0] + yy + zz + r11,
            f[1] + xx + zz + r22,
            f[2] + xx + yy + r33,
            f[3] - mr.x * r.y,
            f[4] - mr.x * r.z + r13,
            f[5] - mr.y * r.z,
        ]);
        let moment = Vec3::new(mr.x + b.rear.moment[0], mr.y, mr.z + b.rear.moment[1]);
        let steer_momentum = Vec3::new(-(sd * b.front.moment[0]), cd * b.front.moment[0], S::constant(0.0));
        let steer_angular = Vec3::new(
            f[4] - r.z * steer_momentum.y,
            f[5] + r.z * steer_momentum.x,
            r.x * steer_momentum.y - r.y * steer_momentum.x + c,
        );
        Self { front, moment, whole, steer_momentum, steer_angular }
    }

    /// The mass matrix of (roll rate, steer rate, rear wheel rate): 11, 12, 13, 22, 23, 33.
    #[inline(always)]
    pub(super) fn mass(&self, b: &Geometry, pose: &Pose<S>, partial: &[Velocities<S>; 3]) -> [S; 6] {
        let [u, v, w] = partial;
        let (by_roll, by_steer, by_wheel) =
            (self.momenta(b, pose, u), self.momenta(b, pose, v), self.momenta(b, pose, w));
        [
            u.power(b, pose, &by_roll),
            u.power(b, pose, &by_steer),
            u.power(b, pose, &by_wheel),
            v.power(b, pose, &by_steer),
            v.power(b, pose, &by_wheel),
            w.power(b, pose, &by_wheel),
        ]
    }

    /// Momenta of one set of velocities.
    #[inline(always)]
    pub(super) fn momenta(&self, b: &Geometry, pose: &Pose<S>, v: &Velocities<S>) -> Momenta<S> {
        let axle = v.axle(b, pose.e1);
        let spin = v.front_spin * b.front.spin_inertia;
        let mut angular = self.whole.times(v.omega)
            + self.moment.cross(axle)
            + pose.f2.times(spin)
            + self.steer_angular.times(v.steer);
        angular.y = angular.y + v.rear_spin * b.rear.spin_inertia;
        let about_f2 = pose.f2.x * v.omega.x + pose.f2.y * v.omega.y;
        Momenta {
            momentum: axle.scaled(b.rear.mass + b.front.mass)
                + v.omega.cross(self.moment)
                + self.steer_momentum.times(v.steer),
            angular,
            steer: self.steer_angular.dot(v.omega)
                + self.steer_momentum.x * axle.x
                + self.steer_momentum.y * axle.y
                + v.steer * (b.front.inertia[2] + b.front.moment[0] * b.front.com[0] + b.rotor_kg_m2),
            rear_axle: v.rolling * b.rear.spin_inertia,
            front_axle: spin + about_f2 * b.front.spin_inertia,
        }
    }
}

/// Momenta, or forces, dual to [`Velocities`].
pub(super) struct Momenta<S> {
    /// Linear.
    pub(super) momentum: Vec3<S>,
    /// Angular about P.
    pub(super) angular: Vec3<S>,
    /// About the steer axis, of the front frame.
    pub(super) steer: S,
    /// About the rear axle, of the wheel.
    pub(super) rear_axle: S,
    /// About the front axle, of the wheel.
    pub(super) front_axle: S,
}

impl<S: Scalar> Velocities<S> {
    /// Power of forces at these velocities (or the scalar product with momenta).
    #[inline(always)]
    pub(super) fn power(&self, b: &Geometry, pose: &Pose<S>, f: &Momenta<S>) -> S {
        let along = pose.e1.x * f.momentum.x + pose.e1.z * f.momentum.z;
        (self.roll * f.momentum.y - self.rolling * along) * b.rR
            + self.omega.dot(f.angular)
            + self.steer * f.steer
            + self.rear_spin * f.rear_axle
            + self.front_spin * f.front_axle
    }
}
