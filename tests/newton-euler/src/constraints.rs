//! The 21 constraints on the bodies' 24 velocities, and their rates.
//!
//! Velocities are ordered body by body: the centre of mass' velocity, then the angular velocity.

use super::bodies::{Bicycle, Contact, Hinge};
use nalgebra::{DMatrix, DVector, Vector3};

/// Constraint rows: five per hinge, three per contact.
pub(super) const ROWS: usize = 21;
/// Velocities of four bodies.
pub(super) const COLUMNS: usize = 24;
/// The first row of the contacts.
pub(super) const CONTACT_ROWS: usize = 15;

/// A body's angular velocity out of all velocities.
pub(super) fn angular(velocities: &DVector<f64>, body: usize) -> Vector3<f64> {
    velocities.fixed_rows::<3>(6 * body + 3).into_owned()
}

/// The matrix `J` of the constraints `J * velocities = 0`.
pub(super) fn jacobian(bicycle: &Bicycle) -> DMatrix<f64> {
    let mut j = DMatrix::zeros(ROWS, COLUMNS);
    for (i, hinge) in bicycle.hinges.iter().enumerate() {
        let row = 5 * i;
        add_point(&mut j, row, hinge.child, &arm(bicycle, hinge, hinge.child), 1.0);
        add_point(&mut j, row, hinge.parent, &arm(bicycle, hinge, hinge.parent), -1.0);
        for (k, across) in across(&hinge.axis).iter().enumerate() {
            for axis in 0..3 {
                j[(row + 3 + k, 6 * hinge.child + 3 + axis)] = across[axis];
                j[(row + 3 + k, 6 * hinge.parent + 3 + axis)] = -across[axis];
            }
        }
    }
    for (i, contact) in bicycle.contacts.iter().enumerate() {
        add_point(&mut j, CONTACT_ROWS + 3 * i, contact.wheel, &contact.arm(), 1.0);
    }
    j
}

/// Terms of the constraints' second derivative other than `J * accelerations`.
pub(super) fn rates(bicycle: &Bicycle, velocities: &DVector<f64>) -> DVector<f64> {
    let mut rates = DVector::zeros(ROWS);
    for (i, hinge) in bicycle.hinges.iter().enumerate() {
        let (parent, child) = (angular(velocities, hinge.parent), angular(velocities, hinge.child));
        let centripetal = |w: &Vector3<f64>, body| w.cross(&w.cross(&arm(bicycle, hinge, body)));
        let point = centripetal(&child, hinge.child) - centripetal(&parent, hinge.parent);
        rates.fixed_rows_mut::<3>(5 * i).copy_from(&point);
        for (k, across) in across(&hinge.axis).iter().enumerate() {
            rates[5 * i + 3 + k] = parent.cross(across).dot(&(child - parent));
        }
    }
    for (i, contact) in bicycle.contacts.iter().enumerate() {
        rates.fixed_rows_mut::<3>(CONTACT_ROWS + 3 * i).copy_from(&contact_rate(contact, velocities));
    }
    rates
}

fn contact_rate(contact: &Contact, velocities: &DVector<f64>) -> Vector3<f64> {
    let omega = angular(velocities, contact.wheel);
    omega.cross(&contact.arm_rate(&omega))
}

/// From a body's centre of mass to a hinge.
fn arm(bicycle: &Bicycle, hinge: &Hinge, body: usize) -> Vector3<f64> {
    hinge.point - bicycle.bodies[body].centre
}

/// Two directions across an axis, fixed to the hinge's parent.
fn across(axis: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let other = if axis.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() };
    let first = axis.cross(&other).normalize();
    [first, axis.cross(&first)]
}

/// Adds the velocity of a body's point, `v + omega x arm`, to three rows.
fn add_point(j: &mut DMatrix<f64>, row: usize, body: usize, arm: &Vector3<f64>, sign: f64) {
    let turn = -arm.cross_matrix() * sign;
    for a in 0..3 {
        j[(row + a, 6 * body + a)] = sign;
        for b in 0..3 {
            j[(row + a, 6 * body + 3 + b)] = turn[(a, b)];
        }
    }
}
