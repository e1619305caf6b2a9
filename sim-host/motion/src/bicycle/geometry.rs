//! Constants of the equations of motion, from the parameters: lengths along and across the steer axis, and
//! each wheel combined with its frame.
#![allow(non_snake_case, reason = "the symbols of the paper")]

use super::Parameters;
use crate::num::sin_cos;

/// A frame with its wheel: one rigid body, plus the wheel's spin about its axle.
///
/// A wheel is symmetric about its axle, so its rotation changes neither centre of mass nor inertia. It only
/// adds the angular momentum `spin_inertia * spin`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gyrostat {
    /// Mass of frame and wheel \[kg\].
    pub mass: f64,
    /// Centre of mass \[m\]: across the steer axis (forward) and along it (down).
    pub com: [f64; 2],
    /// Inertia about the centre of mass: 11, 22, 33, 13 in the steer-axis frame \[kg m^2\].
    pub inertia: [f64; 4],
    /// The wheel's inertia about its axle \[kg m^2\].
    pub spin_inertia: f64,
    /// Mass times `com` \[kg m\].
    pub moment: [f64; 2],
    /// Inertia about the reference point of `com` \[kg m^2\]: 11, 22, 33, 13.
    pub about_origin: [f64; 4],
}

/// Constants of one bicycle for the equations of motion.
///
/// Directions in the symmetry plane of the upright bicycle: `u1` forward perpendicular to the steer
/// axis, `u3` down along it. `P` is the rear wheel's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// Wheel base \[m\].
    pub w: f64,
    /// Rear wheel radius \[m\].
    pub rR: f64,
    /// Front wheel radius \[m\].
    pub rF: f64,
    /// Steer axis tilt \[rad\].
    pub lam: f64,
    /// Gravity \[m/s^2\].
    pub g: f64,
    /// From P to the steer axis along u1 \[m\].
    pub d1: f64,
    /// From P to the front wheel's centre along u3 \[m\].
    pub d2: f64,
    /// From the steer axis to the front wheel's centre along u1 (negative for usual trail) \[m\].
    pub d3: f64,
    /// Rear frame with rear wheel; `com` is measured from P.
    pub rear: Gyrostat,
    /// Front frame with front wheel; `com` is measured from the steer axis, at P's height along it.
    pub front: Gyrostat,
    /// Inertia of a motor's rotor reflected to the steer axis: gear ratio squared times its own \[kg m^2\].
    /// Added to the steer entry of the mass matrix. Its coupling to the rotation of the frame is smaller by
    /// the gear ratio and neglected. [`Self::new`] sets 0.
    pub rotor_kg_m2: f64,
}

impl Geometry {
    /// The constants of a bicycle.
    pub fn new(p: &Parameters) -> Self {
        let (s, c) = sin_cos(p.lam);
        // Components along u1 and u3 of a vector (x, z) in the upright bicycle's plane.
        let along = |x: f64, z: f64| [x * c - z * s, x * s + z * c];
        let P = [0.0, -p.rR];
        let rear = lump(
            (p.mR, along(0.0, 0.0), p.IRxx, p.IRyy),
            (p.mB, along(p.xB - P[0], p.zB - P[1]), tilt([p.IBxx, p.IByy, p.IBzz, p.IBxz], s, c)),
        );
        let Q = along(p.w - P[0], -p.rF - P[1]);
        let d3 = -p.c * c + p.rF * s;
        let d1 = Q[0] - d3;
        let H = along(p.xH - P[0], p.zH - P[1]);
        let front = lump(
            (p.mF, [d3, Q[1]], p.IFxx, p.IFyy),
            (p.mH, [H[0] - d1, H[1]], tilt([p.IHxx, p.IHyy, p.IHzz, p.IHxz], s, c)),
        );
        Self {
            w: p.w,
            rR: p.rR,
            rF: p.rF,
            lam: p.lam,
            g: p.g,
            d1,
            d2: Q[1],
            d3,
            rear,
            front,
            rotor_kg_m2: 0.0,
        }
    }
}

/// Inertia (xx, yy, zz, xz) in axes rotated by the steer axis tilt about y.
fn tilt([xx, yy, zz, xz]: [f64; 4], s: f64, c: f64) -> [f64; 4] {
    [
        xx * c * c - 2.0 * xz * s * c + zz * s * s,
        yy,
        xx * s * s + 2.0 * xz * s * c + zz * c * c,
        (xx - zz) * s * c + xz * (c * c - s * s),
    ]
}

/// Combines a wheel (mass, centre, inertia across and about the axle) and a frame (mass, centre, inertia)
/// into one body.
fn lump(wheel: (f64, [f64; 2], f64, f64), frame: (f64, [f64; 2], [f64; 4])) -> Gyrostat {
    let ((m1, r1, across, about), (m2, r2, inertia)) = (wheel, frame);
    let mass = m1 + m2;
    let com = [(m1 * r1[0] + m2 * r2[0]) / mass, (m1 * r1[1] + m2 * r2[1]) / mass];
    // Parallel-axis theorem: the reduced mass at the distance of the two centres.
    let reduced = m1 * m2 / mass;
    let (x, z) = (r2[0] - r1[0], r2[1] - r1[1]);
    let inertia = [
        across + inertia[0] + reduced * z * z,
        about + inertia[1] + reduced * (x * x + z * z),
        across + inertia[2] + reduced * x * x,
        inertia[3] - reduced * x * z,
    ];
    let moment = [mass * com[0], mass * com[1]];
    let about_origin = [
        inertia[0] + moment[1] * com[1],
        inertia[1] + moment[0] * com[0] + moment[1] * com[1],
        inertia[2] + moment[0] * com[0],
        inertia[3] - moment[0] * com[1],
    ];
    Gyrostat { mass, com, inertia, spin_inertia: about, moment, about_origin }
}
