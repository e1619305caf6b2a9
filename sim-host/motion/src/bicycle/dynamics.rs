//! Accelerations and energy from motion and torques: d'Alembert's principle projected on the partial
//! velocities (Kane's equations). Derivation: `docs/bicycle.md`.

use super::bias::bias;
use super::inertia::Inertia;
use super::{Forces, Geometry, Motion, State};
use crate::num::Scalar;

/// Applied torques \[N m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torques<S> {
    /// On the rear frame about the horizontal heading line through the rear contact, right positive. Its
    /// virtual power is `roll * roll_rate`.
    pub roll: S,
    /// Between rear and front frame about the steer axis, on the front frame to the right positive.
    pub steer: S,
}

/// Accelerations of the independent speeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accelerations<S> {
    /// Roll \[rad/s^2\].
    pub roll: S,
    /// Steer \[rad/s^2\].
    pub steer: S,
    /// Rear wheel relative to the rear frame \[rad/s^2\].
    pub rear_wheel: S,
}

impl<S: Scalar> Motion<S> {
    /// Accelerations under `torques` and gravity.
    #[inline(always)]
    pub fn accelerations(&self, b: &Geometry, torques: &Torques<S>) -> Accelerations<S> {
        let (mass, force) = self.equations(b, |forces| against(torques, forces));
        solve(&mass, force).into()
    }

    /// Accelerations under `torques` and gravity, and their derivatives by the steer torque \[1/(kg m^2)\].
    #[inline(always)]
    pub(crate) fn accelerations_by_steer(
        &self,
        b: &Geometry,
        torques: &Torques<S>,
    ) -> (Accelerations<S>, Accelerations<S>) {
        let (mass, force) = self.equations(b, |forces| against(torques, forces));
        let unit = [0.0, 1.0, 0.0].map(S::constant);
        (solve(&mass, force).into(), solve(&mass, unit).into())
    }

    /// Accelerations under generalised forces and gravity.
    pub fn accelerations_under(&self, b: &Geometry, forces: &Forces<S>) -> Accelerations<S> {
        let [f1, f2, f3] = forces.0;
        let (mass, force) = self.equations(b, |[roll, steer, wheel]| [f1 - roll, f2 - steer, f3 - wheel]);
        solve(&mass, force).into()
    }

    /// Mass matrix and right-hand side of the equations for the accelerations; `applied` adds the applied forces to those of
    /// the bias.
    #[inline(always)]
    fn equations(&self, b: &Geometry, applied: impl FnOnce([S; 3]) -> [S; 3]) -> ([S; 6], [S; 3]) {
        let inertia = Inertia::new(b, &self.pose);
        let mass = inertia.mass(b, &self.pose, &self.partial);
        let (bias, _) = bias(b, &self.pose, &self.actual, &inertia, Some(&self.contact));
        let [u, v, w] = &self.partial;
        let force = applied([
            u.power::<true, false, false>(b, &self.pose, &bias),
            v.power::<false, true, false>(b, &self.pose, &bias),
            w.power::<false, false, true>(b, &self.pose, &bias),
        ]);
        (mass, force)
    }

    /// Kinetic plus potential energy \[J\]; the potential energy is zero when the centres of mass are at
    /// ground height.
    pub fn energy(&self, b: &Geometry, state: &State<S>) -> S {
        let inertia = Inertia::new(b, &self.pose);
        let [m11, m12, m13, m22, m23, m33] = inertia.mass(b, &self.pose, &self.partial);
        let (p, q, r) = (state.roll_rate, state.steer_rate, state.rear_wheel_rate);
        let twice = m11 * p * p + m22 * q * q + m33 * r * r + (m12 * p * q + m13 * p * r + m23 * q * r) * 2.0;
        let (_, cr) = self.pose.attitude.roll;
        let moment = self.pose.k.dot(inertia.moment) - cr * (b.rR * (b.rear.mass + b.front.mass));
        twice * 0.5 + moment * -b.g
    }
}

/// The applied torques less the forces of the bias.
#[inline(always)]
fn against<S: Scalar>(torques: &Torques<S>, [roll, steer, wheel]: [S; 3]) -> [S; 3] {
    [torques.roll - roll, torques.steer - steer, -wheel]
}

impl<S> From<[S; 3]> for Accelerations<S> {
    #[inline(always)]
    fn from([roll, steer, rear_wheel]: [S; 3]) -> Self {
        Self { roll, steer, rear_wheel }
    }
}

/// Solves the symmetric positive-definite system by elimination without pivoting, the third unknown first.
#[inline(always)]
pub(super) fn solve<S: Scalar>(&[a11, a12, a13, a22, a23, a33]: &[S; 6], [r1, r2, r3]: [S; 3]) -> [S; 3] {
    let one = S::constant(1.0);
    let inv3 = one / a33;
    let (q1, q2) = (a13 * inv3, a23 * inv3);
    let (b11, b12, b22) = (a11 - q1 * a13, a12 - q1 * a23, a22 - q2 * a23);
    let (s1, s2) = (r1 - q1 * r3, r2 - q2 * r3);
    let inv = one / (b11 * b22 - b12 * b12);
    let x1 = (s1 * b22 - s2 * b12) * inv;
    let x2 = (s2 * b11 - s1 * b12) * inv;
    [x1, x2, (r3 - a13 * x1 - a23 * x2) * inv3]
}
