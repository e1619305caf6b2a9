//! Checks that a bicycle is physically possible: ranges of the parameters, inertias of rigid bodies.

use super::{KEYS, Parameters};
use crate::range::plain;
use std::f64::consts::FRAC_PI_2;

/// A steer axis tilt above this \[rad\] (54 degrees) is probably a head angle; recumbents reach 40.
const STEEPEST_RAD: f64 = 0.95;

/// Unit and allowed range of each parameter, in the order of [`KEYS`].
const RANGES: [(&str, f64, f64); 26] = [
    ("m", 0.1, 5.0),
    ("m", -1.0, 1.0),
    ("rad", -1.0, 1.4),
    ("m/s^2", 0.01, 30.0),
    ("m", 0.02, 1.5),
    ("kg", 1e-6, 100.0),
    ("kg m^2", 1e-9, 100.0),
    ("kg m^2", 1e-9, 100.0),
    ("m", -3.0, 5.0),
    ("m", -5.0, -1e-3),
    ("kg", 1e-3, 1000.0),
    ("kg m^2", 1e-9, 1000.0),
    ("kg m^2", 1e-9, 1000.0),
    ("kg m^2", 1e-9, 1000.0),
    ("kg m^2", -1000.0, 1000.0),
    ("m", -3.0, 5.0),
    ("m", -5.0, -1e-3),
    ("kg", 1e-3, 1000.0),
    ("kg m^2", 1e-9, 1000.0),
    ("kg m^2", 1e-9, 1000.0),
    ("kg m^2", 1e-9, 1000.0),
    ("kg m^2", -1000.0, 1000.0),
    ("m", 0.02, 1.5),
    ("kg", 1e-6, 100.0),
    ("kg m^2", 1e-9, 100.0),
    ("kg m^2", 1e-9, 100.0),
];

/// Unit and range of a parameter, as text.
pub(super) fn describe(key: &str) -> String {
    let Some(i) = KEYS.iter().position(|k| *k == key) else { return String::new() };
    let (unit, min, max) = RANGES[i];
    format!("it must be a number from {min} to {max} {unit}")
}

/// Checks the parameters; returns warnings about doubtful values.
///
/// # Errors
/// The reason why no such bicycle exists: a value outside its range or NaN, or an inertia matrix that is not
/// positive definite.
pub(super) fn check(p: &Parameters) -> Result<Vec<String>, String> {
    for (key, value) in KEYS.iter().zip(p.to_values()) {
        let (_, min, max) = RANGES[KEYS.iter().position(|k| k == key).unwrap_or_default()];
        if !(value >= min && value <= max) {
            return Err(format!("`{key}` = {} is out of range; {}", plain(value), describe(key)));
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
            return Err(format!(
                "`{body}xz` = {xz} is too large for `{body}xx` = {xx} and `{body}zz` = {zz}: the inertia matrix \
                 is not positive definite (allowed: |{body}xz| below {:.6})",
                (xx * zz).sqrt()
            ));
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
