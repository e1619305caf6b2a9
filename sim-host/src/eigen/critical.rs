//! The speeds at which the straight ride changes its nature.

use super::eigenvalues;
use crate::bicycle::linear::Linear;
use control::Law;
use nalgebra::{Complex, ComplexField};

/// Speeds above this are not searched for critical speeds \[m/s\].
pub const SEARCH_TO_M_S: f64 = 20.0;
/// Step of the search without a rider \[m/s\].
const SEARCH_STEP_M_S: f64 = 0.01;

/// Growth below this part of the largest eigenvalue is none: at rest a pair that oscillates is neutral by structure, and
/// its computed real part has the sign of a rounding error; a double zero is split by the root of one.
const NEUTRAL: f64 = 1e-7;

/// The speeds at which the straight ride changes its nature \[m/s\]; `None` where it does not.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct CriticalSpeeds {
    /// Two growing real eigenvalues merge into the weave pair; none if there is a growing pair at
    /// rest. (Two decaying ones may merge before, at a lower speed.)
    pub v_d: Option<f64>,
    /// Weave: the rightmost complex pair moves into the left half plane.
    pub v_w: Option<f64>,
    /// Capsize: a real eigenvalue becomes positive.
    pub v_c: Option<f64>,
}

/// The critical speeds without a rider up to [`SEARCH_TO_M_S`], each by bisection to rounding.
pub fn critical_speeds(bicycle: &Linear, law: &Law) -> CriticalSpeeds {
    let at = |v: f64| eigenvalues(bicycle, law, v);
    // The steady turn: det(g K0 + v^2 K2) changes sign, whatever the roll-rate feedback.
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
        // At rest a pair is there, growing or neutral; or it decays, or all are real.
        v_d: (sign(at_rest.0, at_rest.1) == Some(false))
            .then(|| first(&|v| (-pair(v).0, pair(v).1)))
            .flatten(),
        v_w: first(&pair),
        v_c: first(&turn),
    }
}

/// Whether a value is positive; `None` if it is no more than rounding beside `size`.
fn sign(value: f64, size: f64) -> Option<bool> {
    (value.abs() > NEUTRAL * size).then_some(value > 0.0)
}

/// Whether the growth of one of `values` is positive; `None` if it is no more than rounding.
pub(super) fn grows(growth: f64, values: &[Complex<f64>]) -> Option<bool> {
    sign(growth, largest(values))
}

/// The largest magnitude.
fn largest(values: &[Complex<f64>]) -> f64 {
    values.iter().map(|e| e.modulus()).fold(0.0, f64::max)
}

/// The largest real part of complex values; minus infinity if all are real.
pub(super) fn rightmost_pair(values: &[Complex<f64>]) -> f64 {
    values.iter().filter(|e| e.im != 0.0).map(|e| e.re).fold(f64::NEG_INFINITY, f64::max)
}

/// The first speed at which a value, given with its size, becomes negative. Speeds at which it is no more than rounding do
/// not count, nor the end of a value that goes through minus infinity.
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

/// Where `below` ceases to hold between two speeds, to rounding.
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
