//! Checks that a bicycle is physically possible: ranges of the parameters, inertias of rigid bodies.

use super::error::ParameterError;

use super::{KEYS, Parameters, RANGES};
use std::f64::consts::FRAC_PI_2;

/// A steer axis tilt above this \[rad\] (54 degrees) is probably a head angle; recumbents reach 40.
const STEEPEST_RAD: f64 = 0.95;

/// Checks the parameters; returns warnings about doubtful values.
///
/// # Errors
/// The reason why no such bicycle exists: a value outside its range or NaN, or an inertia matrix that is not
/// positive definite.
pub(super) fn check(p: &Parameters) -> Result<Vec<String>, ParameterError> {
    for ((key, value), (unit, min, max)) in KEYS.into_iter().zip(p.to_values()).zip(RANGES) {
        if !(value >= min && value <= max) {
            return Err(ParameterError::Range { key, value, min, max, unit });
        }
    }
    let mut warnings = Vec::new();
    if p.lam > STEEPEST_RAD {
        warnings.push(format!(
            "`lam` = {} rad leans the steer axis by {:.0} degrees from the vertical; if that is the head angle, measured \
             from the ground, the tilt is pi/2 minus it, {:.4} rad",
            p.lam,
            p.lam.to_degrees(),
            FRAC_PI_2 - p.lam
        ));
    }
    for (body, [xx, yy, zz, xz]) in [
        ("IB", [p.IBxx, p.IByy, p.IBzz, p.IBxz]),
        ("IH", [p.IHxx, p.IHyy, p.IHzz, p.IHxz]),
        ("IR", [p.IRxx, p.IRyy, p.IRxx, 0.0]),
        ("IF", [p.IFxx, p.IFyy, p.IFxx, 0.0]),
    ] {
        let (mean, spread) = (0.5 * (xx + zz), libm::hypot(0.5 * (xx - zz), xz));
        let (small, large) = (mean - spread, mean + spread);
        if small <= 0.0 {
            return Err(ParameterError::NotPositiveDefinite { body, xx, zz, xz });
        }
        let slack = 1e-9 * (small + large + yy);
        if yy > small + large + slack || large > small + yy + slack {
            warnings.push(format!(
                "{body}: principal inertias {small:.6}, {yy:.6}, {large:.6} kg m^2 violate the triangle \
                 inequality; no rigid body has them"
            ));
        }
    }
    Ok(warnings)
}
