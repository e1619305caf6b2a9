//! The linearised bicycle, computed from the parameters: Meijaard et al. 2007, appendix A.
#![allow(non_snake_case, reason = "the symbols of the paper")]

use super::{ForcePoint, Parameters};
use crate::num::sin_cos;
use nalgebra::{Matrix2, Matrix4, Vector2};

/// `M q'' + v C1 q' + (g K0 + v^2 K2) q = T` with `q = [roll, steer]`, `T = [roll, steer torque]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear {
    /// Mass matrix.
    pub m: Matrix2<f64>,
    /// Damping per unit speed.
    pub c1: Matrix2<f64>,
    /// Stiffness per unit gravity.
    pub k0: Matrix2<f64>,
    /// Stiffness per unit speed squared.
    pub k2: Matrix2<f64>,
    /// Gravity \[m/s^2\].
    pub g: f64,
    /// Mechanical trail by wheelbase, `c cos(lam) / w`: yaw rate of the rear frame per unit steer rate.
    pub mu: f64,
}

impl Linear {
    /// Canonical matrices of a bicycle.
    pub fn new(p: &Parameters) -> Self {
        let (sin, cos) = sin_cos(p.lam);
        let (IRzz, IFzz) = (p.IRxx, p.IFxx);
        // The whole bicycle (T).
        let mT = p.mR + p.mB + p.mH + p.mF;
        let xT = (p.xB * p.mB + p.xH * p.mH + p.w * p.mF) / mT;
        let zT = (-p.rR * p.mR + p.zB * p.mB + p.zH * p.mH - p.rF * p.mF) / mT;
        let ITxx = p.IRxx
            + p.IBxx
            + p.IHxx
            + p.IFxx
            + p.mR * p.rR.powi(2)
            + p.mB * p.zB.powi(2)
            + p.mH * p.zH.powi(2)
            + p.mF * p.rF.powi(2);
        let ITxz = p.IBxz + p.IHxz - p.mB * p.xB * p.zB - p.mH * p.xH * p.zH + p.mF * p.w * p.rF;
        let ITzz =
            IRzz + p.IBzz + p.IHzz + IFzz + p.mB * p.xB.powi(2) + p.mH * p.xH.powi(2) + p.mF * p.w.powi(2);
        // The front assembly (A).
        let mA = p.mH + p.mF;
        let xA = (p.xH * p.mH + p.w * p.mF) / mA;
        let zA = (p.zH * p.mH - p.rF * p.mF) / mA;
        let IAxx = p.IHxx + p.IFxx + p.mH * (p.zH - zA).powi(2) + p.mF * (p.rF + zA).powi(2);
        let IAxz = p.IHxz - p.mH * (p.xH - xA) * (p.zH - zA) + p.mF * (p.w - xA) * (p.rF + zA);
        let IAzz = p.IHzz + IFzz + p.mH * (p.xH - xA).powi(2) + p.mF * (p.w - xA).powi(2);
        let uA = (xA - p.w - p.c) * cos - zA * sin;
        let IAll = mA * uA.powi(2) + IAxx * sin.powi(2) + 2.0 * IAxz * sin * cos + IAzz * cos.powi(2);
        let IAlx = -mA * uA * zA + IAxx * sin + IAxz * cos;
        let IAlz = mA * uA * xA + IAxz * sin + IAzz * cos;
        let mu = p.c / p.w * cos;
        let (SR, SF) = (p.IRyy / p.rR, p.IFyy / p.rF);
        let ST = SR + SF;
        let SA = mA * uA + mu * mT * xT;
        let gyro = mu * ST + SF * cos;
        Self {
            m: symmetric(ITxx, IAlx + mu * ITxz, IAll + 2.0 * mu * IAlz + mu * mu * ITzz),
            c1: Matrix2::new(
                0.0,
                gyro + ITxz / p.w * cos - mu * mT * zT,
                -gyro,
                IAlz / p.w * cos + mu * (SA + ITzz / p.w * cos),
            ),
            k0: symmetric(mT * zT, -SA, -SA * sin),
            k2: Matrix2::new(0.0, (ST - mT * zT) / p.w * cos, 0.0, (SA + SF * sin) / p.w * cos),
            g: p.g,
            mu,
        }
    }

    /// State matrix of `[roll, steer, roll rate, steer rate]` at speed `v` \[m/s\] with a steer torque of
    /// `gain * roll rate`, `gain` in \[N m s/rad\].
    pub fn state_matrix(&self, v: f64, gain: f64) -> Matrix4<f64> {
        let inverse = inverse(&self.m);
        let mut damping = self.c1 * v;
        damping[(1, 0)] -= gain;
        let (k, c) = (-inverse * (self.k0 * self.g + self.k2 * (v * v)), -inverse * damping);
        let mut a = Matrix4::zeros();
        a[(0, 2)] = 1.0;
        a[(1, 3)] = 1.0;
        a.fixed_view_mut::<2, 2>(2, 0).copy_from(&k);
        a.fixed_view_mut::<2, 2>(2, 2).copy_from(&c);
        a
    }

    /// Accelerations of roll and steer per unit steer torque \[rad/s^2 per N m\].
    pub fn steer_torque_response(&self) -> Vector2<f64> {
        inverse(&self.m).column(1).into()
    }

    /// Accelerations of roll and steer of the bicycle at rest under generalised forces on roll and steer.
    pub fn acceleration(&self, forces: Vector2<f64>) -> Vector2<f64> {
        inverse(&self.m) * forces
    }

    /// Generalised forces on roll and steer \[N m per N\] of a lateral force of 1 N to the right on the rear frame;
    /// the inverse of `m` times them are accelerations.
    ///
    /// By virtual work: the point moves to the right by `height` per unit roll and by `ahead` per unit yaw, and at
    /// rest the bicycle yaws by `mu` per unit steer.
    pub fn lateral_force_input(&self, point: ForcePoint) -> [f64; 2] {
        [point.height_m, self.mu * point.ahead_m]
    }
}

fn symmetric(a: f64, b: f64, c: f64) -> Matrix2<f64> {
    Matrix2::new(a, b, b, c)
}

fn inverse(m: &Matrix2<f64>) -> Matrix2<f64> {
    let det = m[(0, 0)] * m[(1, 1)] - m[(0, 1)] * m[(1, 0)];
    Matrix2::new(m[(1, 1)], -m[(0, 1)], -m[(1, 0)], m[(0, 0)]) / det
}
