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
        let by_roll = self.momenta::<true, false, false>(b, pose, u);
        let by_steer = self.momenta::<false, true, false>(b, pose, v);
        let by_wheel = self.momenta::<false, false, true>(b, pose, w);
        [
            u.power::<true, false, false>(b, pose, &by_roll),
            u.power::<true, false, false>(b, pose, &by_steer),
            u.power::<true, false, false>(b, pose, &by_wheel),
            v.power::<false, true, false>(b, pose, &by_steer),
            v.power::<false, true, false>(b, pose, &by_wheel),
            w.power::<false, false, true>(b, pose, &by_wheel),
        ]
    }

    /// Momenta of one set of velocities. Roll rate, steer rate or rear wheel rate is zero if its constant is `false`: the
    /// compiler must not leave out a product with zero.
    #[inline(always)]
    pub(super) fn momenta<const ROLL: bool, const STEER: bool, const WHEEL: bool>(
        &self,
        b: &Geometry,
        pose: &Pose<S>,
        v: &Velocities<S>,
    ) -> Momenta<S> {
        // Components that are zero for every pose: e1.y, f2.z, steer_momentum.z.
        let (w, m, f2) = (v.omega, self.moment, pose.f2);
        let forward = v.rolling * -b.rR;
        let (x, y, z) = (pose.e1.x * forward, v.roll * b.rR, pose.e1.z * forward);
        let spin = v.front_spin * b.front.spin_inertia;
        let mass = b.rear.mass + b.front.mass;
        let whole = self.whole.times(w);
        let mut angular = Vec3::new(m.y * z, m.z * x - m.x * z, -(m.y * x));
        let mut momentum = Vec3::new(x * mass, S::constant(0.0), z * mass) + w.cross(m);
        let mut steer = self.steer_angular.dot(w) + self.steer_momentum.x * x;
        if ROLL {
            angular = Vec3::new(m.y * z - m.z * y, angular.y, m.x * y - m.y * x);
            momentum.y = y * mass + (w.z * m.x - w.x * m.z);
            steer = steer + self.steer_momentum.y * y;
        }
        angular = Vec3::new(
            whole.x + angular.x + f2.x * spin,
            whole.y + angular.y + f2.y * spin,
            whole.z + angular.z,
        );
        if STEER {
            angular = angular + self.steer_angular.times(v.steer);
            momentum.x = momentum.x + self.steer_momentum.x * v.steer;
            momentum.y = momentum.y + self.steer_momentum.y * v.steer;
            steer =
                steer + v.steer * (b.front.inertia[2] + b.front.moment[0] * b.front.com[0] + b.rotor_kg_m2);
        }
        if WHEEL {
            angular.y = angular.y + v.rear_spin * b.rear.spin_inertia;
        }
        Momenta {
            momentum,
            angular,
            steer,
            rear_axle: v.rolling * b.rear.spin_inertia,
            front_axle: spin + (f2.x * w.x + f2.y * w.y) * b.front.spin_inertia,
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
    /// Power of forces at these velocities (or the scalar product with momenta); constants as in [`Inertia::momenta`].
    #[inline(always)]
    pub(super) fn power<const ROLL: bool, const STEER: bool, const WHEEL: bool>(
        &self,
        b: &Geometry,
        pose: &Pose<S>,
        f: &Momenta<S>,
    ) -> S {
        let along = self.rolling * (pose.e1.x * f.momentum.x + pose.e1.z * f.momentum.z);
        let axle = if ROLL { self.roll * f.momentum.y - along } else { -along };
        let mut power = axle * b.rR + self.omega.dot(f.angular);
        if STEER {
            power = power + self.steer * f.steer;
        }
        if WHEEL {
            power = power + self.rear_spin * f.rear_axle;
        }
        power + self.front_spin * f.front_axle
    }
}
