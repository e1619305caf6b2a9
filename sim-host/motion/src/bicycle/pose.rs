//! Directions and lever arms of a configuration, from its angles.
//!
//! All vectors of the equations of motion are in the steer-axis frame, which is fixed to the rear
//! frame: `u1` forward and perpendicular to the steer axis, `u2` along the rear axle to the right,
//! `u3` down along the steer axis. `P` is the rear wheel's centre.

use super::Geometry;
use super::pitch::Attitude;
use crate::num::{Scalar, Vec3};

/// Directions and lever arms of one configuration.
#[derive(Clone, Copy, Debug)]
pub struct Pose<S> {
    /// Sines and cosines of the angles, and the pitch.
    pub attitude: Attitude<S>,
    /// Vertical, down.
    pub k: Vec3<S>,
    /// The rear wheel's heading: horizontal, forward.
    pub e1: Vec3<S>,
    /// From P to the rear contact, unit length.
    pub e3: Vec3<S>,
    /// Across the steer axis, forward in the front frame.
    pub f1: Vec3<S>,
    /// Along the front axle, to the right.
    pub f2: Vec3<S>,
    /// From the front wheel's centre to its contact, unit length.
    pub down: Vec3<S>,
    /// The front wheel's heading: horizontal, forward.
    pub heading: Vec3<S>,
    /// Horizontal, to the right of `heading`.
    pub lateral: Vec3<S>,
    /// Sine of the front wheel's lean.
    pub n: S,
    /// One over the cosine of the front wheel's lean.
    pub per_m: S,
    /// From the steer axis to the front contact, without the component along the axis.
    pub trail: Vec3<S>,
    /// From the rear to the front contact; horizontal.
    pub base: Vec3<S>,
    /// From P to the front gyrostat's centre of mass.
    pub front_com: Vec3<S>,
}

impl<S: Scalar> Pose<S> {
    /// Pose of an attitude.
    #[inline(always)]
    pub(super) fn new(b: &Geometry, attitude: Attitude<S>) -> Self {
        let ((sr, cr), (sd, cd), (st, ct)) = (attitude.roll, attitude.steer, attitude.tilt);
        let (zero, one) = (S::constant(0.0), S::constant(1.0));
        let k = Vec3::new(-(st * cr), sr, ct * cr);
        let e1 = Vec3::new(ct, zero, st);
        let e3 = Vec3::new(-st, zero, ct);
        let f1 = Vec3::new(cd, sd, zero);
        let f2 = Vec3::new(-sd, cd, zero);
        let n = cd * sr - sd * k.x;
        let m2 = one - n * n;
        let m = m2.sqrt();
        let per_m = one / m;
        let down = Vec3::new((k.x + n * sd) * per_m, (k.y - n * cd) * per_m, k.z * per_m);
        let heading = Vec3::new(cd * down.z, sd * down.z, -(sd * down.y + cd * down.x));
        let lateral = Vec3::new(-(m * sd + n * down.x), m * cd - n * down.y, -(n * down.z));
        let trail = Vec3::new(cd * b.d3 + down.x * b.rF, sd * b.d3 + down.y * b.rF, down.z * b.rF);
        let base = Vec3::new(trail.x + st * b.rR + b.d1, trail.y, trail.z - ct * b.rR + b.d2);
        let front_com =
            Vec3::new(cd * b.front.com[0] + b.d1, sd * b.front.com[0], S::constant(b.front.com[1]));
        Self { attitude, k, e1, e3, f1, f2, down, heading, lateral, n, per_m, trail, base, front_com }
    }
}
