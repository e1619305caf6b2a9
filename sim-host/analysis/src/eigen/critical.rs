//! Critical speeds of straight riding without a rider, from the linearised bicycle and a law.

use super::eigenvalues;
use control::Law;
use nalgebra::{Complex, ComplexField};
use physics::bicycle::linear::Linear;

/// Upper end of the search for critical speeds \[m/s\].
pub const SEARCH_TO_M_S: f64 = 20.0;
/// Step of the search without a rider \[m/s\].
const SEARCH_STEP_M_S: f64 = 0.01;

/// A real part below this fraction of the largest eigenvalue counts as zero. At rest an oscillating pair is
/// neutral by structure, and the sign of its computed real part is a rounding error; rounding splits a double
/// zero by the square root of its error.
const NEUTRAL: f64 = 1e-7;

/// Speeds at which the stability of straight riding changes \[m/s\]; `None` for changes that do not occur.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct CriticalSpeeds {
    /// Double-root speed: two unstable real eigenvalues merge into the weave pair. None if there is an
    /// unstable pair at rest. (Two stable ones can merge before, at a lower speed.)
    pub v_d: Option<f64>,
    /// Weave speed: the rightmost complex pair moves into the left half plane.
    pub v_w: Option<f64>,
    /// Capsize speed: a real eigenvalue becomes positive.
    pub v_c: Option<f64>,
}

/// Critical speeds without a rider up to [`SEARCH_TO_M_S`], each by bisection to rounding.
pub fn critical_speeds(bicycle: &Linear, law: &Law) -> CriticalSpeeds {
    let at = |v: f64| eigenvalues(bicycle, law, v);
    // Steady turning: det(g K0 + v^2 K2) changes its sign, independent of roll-rate feedback.
    let turn = |v: f64| {
        let k = bicycle.k0 * bicycle.g + bicycle.k2 * (v * v);
        let size = (k[(0, 0)] * k[(1, 1)]).abs() + (k[(0, 1)] * k[(1, 0)]).abs();
        (k.determinant(), size)
    };
    let pair = |v: f64| {
        let values = at(v);
        (rightmost_pair(&values), largest(&values))
    };
    let at_rest = pair(0.0);
    CriticalSpeeds {
        // At rest there is an unstable or neutral pair, or it is stable, or all eigenvalues are real.
        v_d: (sign(at_rest.0, at_rest.1) == Some(false))
            .then(|| first(&|v| (-pair(v).0, pair(v).1)))
            .flatten(),
        v_w: first(&pair),
        v_c: first(&turn),
    }
}

/// Whether a value is positive; `None` if it is zero within rounding relative to `size`.
fn sign(value: f64, size: f64) -> Option<bool> {
    (value.abs() > NEUTRAL * size).then_some(value > 0.0)
}

/// Whether the real part of one of `values` is positive; `None` if it is zero within rounding.
pub(super) fn grows(growth: f64, values: &[Complex<f64>]) -> Option<bool> {
    sign(growth, largest(values))
}

/// Largest magnitude.
fn largest(values: &[Complex<f64>]) -> f64 {
    values.iter().map(|e| e.modulus()).fold(0.0, f64::max)
}

/// Largest real part of the complex values; minus infinity if all are real.
pub(super) fn rightmost_pair(values: &[Complex<f64>]) -> f64 {
    values.iter().filter(|e| e.im != 0.0).map(|e| e.re).fold(f64::NEG_INFINITY, f64::max)
}

/// First speed at which a value, given with its size, becomes negative. Speeds at which the value is zero
/// within rounding are ignored, and so is a step to minus infinity.
fn first(f: &dyn Fn(f64) -> (f64, f64)) -> Option<f64> {
    let steps = (SEARCH_TO_M_S / SEARCH_STEP_M_S).round() as usize;
    let mut positive = None;
    for v in (0..=steps).map(|i| i as f64 * SEARCH_STEP_M_S) {
        let (value, size) = f(v);
        match (sign(value, size), positive) {
            (Some(true), _) => positive = Some(v),
            (Some(false), _) if value == f64::NEG_INFINITY => positive = None,
            (Some(false), Some(low)) => return Some(bisect((low, v), |v| f(v).0 > 0.0)),
            _ => {}
        }
    }
    None
}

/// Bisects to rounding for the speed at which `below` ceases to hold.
pub(super) fn bisect((mut low, mut high): (f64, f64), below: impl Fn(f64) -> bool) -> f64 {
    while high - low > 4.0 * f64::EPSILON * high {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if below(middle) { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
