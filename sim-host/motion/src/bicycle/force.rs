//! Generalised forces of an external lateral force on the rear frame.

use super::{Geometry, Motion, Torques, Velocities};
use crate::num::{Scalar, Vec3, sin_cos};
use std::fmt;

/// A material point of the rear frame on the symmetry plane, by its place in the upright bicycle.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct ForcePoint {
    /// Ahead of the rear contact \[m\].
    pub ahead_m: f64,
    /// Above the ground \[m\].
    pub height_m: f64,
}

/// Generalised forces \[N m\]: what they multiply, the independent speeds roll rate, steer rate and the rear
/// wheel's rate relative to the rear frame, gives their power.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forces<S>(pub [S; 3]);

impl<S: Scalar> From<Torques<S>> for Forces<S> {
    fn from(torques: Torques<S>) -> Self {
        Self([torques.roll, torques.steer, S::constant(0.0)])
    }
}

impl<S: Scalar> Forces<S> {
    /// The sum with other forces.
    pub fn and(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + other.0[i]))
    }
}

impl fmt::Display for ForcePoint {
    /// As on the command line: `AHEAD,HEIGHT` \[m\].
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{}", self.ahead_m, self.height_m)
    }
}

impl ForcePoint {
    /// Beneath the saddle of the Davis bicycle, 0.198 m ahead of the rear contact and 0.943 m up (`RigidJasonPar.txt` of
    /// moorepants/HumanControl): where the rope of Moore's experiment pulled (2012).
    pub const SADDLE: Self = Self { ahead_m: 0.198_437_5, height_m: 0.942_975 };

    /// From P, the rear wheel's centre, in the steer-axis frame \[m\]: forward across the steer axis, and down along it.
    fn arm(self, b: &Geometry) -> [f64; 2] {
        let (s, c) = sin_cos(b.lam);
        let (x, z) = (self.ahead_m, b.rR - self.height_m);
        [x * c - z * s, x * s + z * c]
    }
}

impl<S: Scalar> Motion<S> {
    /// Generalised forces of a lateral force \[N\] on `point`: horizontal, across the rear wheel's heading, to the
    /// right positive.
    ///
    /// Virtual power: each is the force times the lateral velocity of the point at a unit independent speed, the
    /// others zero. The wheels roll without slip, so that a steer rate moves the point by yaw and pitch.
    pub fn lateral_force(&self, b: &Geometry, point: ForcePoint, force_n: S) -> Forces<S> {
        Forces(self.partial.map(|v| self.lateral(b, point, &v) * force_n))
    }

    /// Lateral velocity \[m/s\] of `point`, to the right of the rear wheel's heading positive.
    pub fn lateral_velocity(&self, b: &Geometry, point: ForcePoint) -> S {
        self.lateral(b, point, &self.actual)
    }

    fn lateral(&self, b: &Geometry, point: ForcePoint, v: &Velocities<S>) -> S {
        let (e1, k) = (self.pose.e1, self.pose.k);
        let [x, z] = point.arm(b);
        let arm = Vec3::new(S::constant(x), S::constant(0.0), S::constant(z));
        (v.axle(b, e1) + v.omega.cross(arm)).dot(k.cross(e1))
    }
}
