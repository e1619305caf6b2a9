//! Bias forces: inertial and gravity forces at constant independent speeds (centripetal, gyroscopic, from the
//! constraints). `docs/bicycle.md`, section 6.

use super::inertia::{Inertia, Momenta};
use super::motion::Contact;
use super::{Geometry, Gyrostat, Pose, Velocities};
use crate::num::{Scalar, Vec3};

/// Two results: the forces and moments needed to move the bicycle against gravity with zero independent
/// accelerations; and the acceleration of the front contact without pitch, yaw and front wheel acceleration.
///
/// With `contact`, these three accelerations cancel that of the front contact; without, they are zero.
#[inline(always)]
pub(super) fn bias<S: Scalar>(
    b: &Geometry,
    p: &Pose<S>,
    v: &Velocities<S>,
    inertia: &Inertia<S>,
    contact: Option<&Contact<S>>,
) -> (Momenta<S>, Vec3<S>) {
    let ((sr, cr), (sd, cd), (st, ct)) = (p.attitude.roll, p.attitude.steer, p.attitude.tilt);
    let zero = S::constant(0.0);
    let w = v.omega;
    let wf = Vec3::new(w.x, w.y, w.z + v.steer);

    // Time derivatives of the directions in the inertial frame. e1 and e3 turn with roll and yaw only.
    let w2 = w.y - v.pitch;
    let e1_dot = Vec3::new(sr * st * v.yaw, cr * v.yaw, -(sr * ct * v.yaw));
    let u2_dot = (-w.z, w.x);
    let e3_dot = Vec3::new(w2 * ct, -(w.z * st + w.x * ct), w2 * st);
    let f1_dot = Vec3::new(-(wf.z * sd), wf.z * cd, w.x * sd - w.y * cd);
    let f2_dot = Vec3::new(-(wf.z * cd), -(wf.z * sd), w.x * cd + w.y * sd);
    // The front wheel's own frame (heading, f2, down) turns with its yaw and its lean.
    let front_yaw = -(f2_dot.dot(p.heading) * p.per_m);
    let front_lean = f2_dot.dot(p.down);
    let turn = front_yaw * p.n;
    let down_dot = Vec3::new(
        p.heading.x * turn - p.f2.x * front_lean,
        p.heading.y * turn - p.f2.y * front_lean,
        p.heading.z * turn,
    );

    // The front contact's acceleration without pitch, yaw and front wheel acceleration.
    let trail_dot = f1_dot.scaled(b.d3) + down_dot.scaled(b.rF);
    let axis_dot = Vec3::new(w.y * b.d2, w.z * b.d1 - w.x * b.d2, -(w.y * b.d1));
    let base_dot = axis_dot + trail_dot - e3_dot.scaled(b.rR);
    let arm_dot = Vec3::new(
        -(w.x * p.trail.z) - trail_dot.y,
        trail_dot.x - w.y * p.trail.z,
        w.y * p.trail.y + w.x * p.trail.x,
    );
    let alpha_free = plus_xz(e1_dot.times(v.roll), u2_dot, v.pitch);
    let free = alpha_free.cross(p.base) + w.cross(base_dot) - e1_dot.times(v.rear_spin * b.rR)
        + arm_dot.times(v.steer)
        + p.lateral.times(v.front_spin * front_yaw * b.rF);
    let [pitch, yaw, front_spin] = match contact {
        Some(contact) => contact.close(b, p, free),
        None => [zero; 3],
    };

    let mut alpha = alpha_free + p.k.times(yaw);
    alpha.y = alpha.y + pitch;
    let alpha_f = Vec3::new(alpha.x + w.y * v.steer, alpha.y - w.x * v.steer, alpha.z);
    // Acceleration of P; gravity acts like an upward acceleration.
    let mut axle = plus_xz(e1_dot.times(v.rolling * -b.rR), u2_dot, v.roll * b.rR) - p.k.scaled(b.g);
    let along = alpha.y * -b.rR;
    axle.x = axle.x + p.e1.x * along;
    axle.z = axle.z + p.e1.z * along;

    // Rear gyrostat about P.
    let s = b.rear.moment;
    let force_r = axle.scaled(b.rear.mass) + swing(alpha, w, s);
    let moment_r = turned(&b.rear, alpha) + w.cross(turned(&b.rear, w));
    let moment_r = plus_xz(moment_r, u2_dot, v.rear_spin * b.rear.spin_inertia)
        + Vec3::new(-(axle.y * s[1]), axle.x * s[1] - axle.z * s[0], axle.y * s[0]);

    // Front gyrostat about its centre of mass.
    let arm = (Vec3::new(-(alpha_f.z * sd), alpha_f.z * cd, alpha_f.x * sd - alpha_f.y * cd)
        + wf.cross(f1_dot))
    .scaled(b.front.com[0]);
    let force_f = (axle + swing(alpha, w, [b.d1, b.front.com[1]]) + arm).scaled(b.front.mass);
    let moment_f = inertia.front.times(alpha_f)
        + wf.cross(inertia.front.times(wf))
        + f2_dot.times(v.front_spin * b.front.spin_inertia);
    let spin = front_spin * b.front.spin_inertia;
    let moment_f = Vec3::new(moment_f.x + p.f2.x * spin, moment_f.y + p.f2.y * spin, moment_f.z);

    let force = Momenta {
        momentum: force_r + force_f,
        angular: moment_r + moment_f + p.front_com.cross(force_f),
        steer: moment_f.z + (cd * force_f.y - sd * force_f.x) * b.front.com[0],
        rear_axle: alpha.y * b.rear.spin_inertia,
        front_axle: (p.f2.x * alpha_f.x + p.f2.y * alpha_f.y + front_spin) * b.front.spin_inertia,
    };
    (force, free)
}

/// Adds a vector without second component, times `s`.
#[inline(always)]
fn plus_xz<S: Scalar>(to: Vec3<S>, (x, z): (S, S), s: S) -> Vec3<S> {
    Vec3::new(to.x + x * s, to.y, to.z + z * s)
}

/// `alpha x r + omega x (omega x r)` for r = (x, 0, z).
#[inline(always)]
fn swing<S: Scalar>(alpha: Vec3<S>, w: Vec3<S>, [x, z]: [f64; 2]) -> Vec3<S> {
    let velocity = Vec3::new(w.y * z, w.z * x - w.x * z, -(w.y * x));
    Vec3::new(alpha.y * z, alpha.z * x - alpha.x * z, -(alpha.y * x)) + w.cross(velocity)
}

/// Product of the inertia about the origin and a vector.
#[inline(always)]
fn turned<S: Scalar>(body: &Gyrostat, a: Vec3<S>) -> Vec3<S> {
    let [i11, i22, i33, i13] = body.about_origin;
    Vec3::new(a.x * i11 + a.z * i13, a.y * i22, a.x * i13 + a.z * i33)
}
