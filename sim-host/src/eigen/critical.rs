//! The speeds at which the straight ride changes its nature.

use super::eigenvalues;
use crate::bicycle::linear::Linear;
use control::Law;
use nalgebra::Complex;

/// Speeds above this are not searched for critical speeds \[m/s\].
pub const SEARCH_TO_M_S: f64 = 20.0;
/// Step of the search without a rider \[m/s\].
const SEARCH_STEP_M_S: f64 = 0.01;

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
    let det = |v: f64| (bicycle.k0 * bicycle.g + bicycle.k2 * (v * v)).determinant();
    let growing_pair = |v: f64| at(v).iter().any(|e| e.im != 0.0 && e.re > 0.0);
    CriticalSpeeds {
        v_d: if growing_pair(0.0) {
            None
        } else {
            upward(&|v| if growing_pair(v) { 1.0 } else { -1.0 }, |_| true)
        },
        v_w: upward(&|v| -rightmost_pair(&at(v)), |v| rightmost_pair(&at(v)).is_finite()),
        v_c: upward(&|v| -det(v), |_| true),
    }
}

/// The largest real part of complex values; minus infinity if all are real.
pub(super) fn rightmost_pair(values: &[Complex<f64>]) -> f64 {
    values.iter().filter(|e| e.im != 0.0).map(|e| e.re).fold(f64::NEG_INFINITY, f64::max)
}

/// The first speed at which `f` goes from negative to not negative, both ends being `valid`.
fn upward(f: &dyn Fn(f64) -> f64, valid: impl Fn(f64) -> bool) -> Option<f64> {
    let steps = (SEARCH_TO_M_S / SEARCH_STEP_M_S).round() as usize;
    let speed = |i: usize| i as f64 * SEARCH_STEP_M_S;
    let bracket = (1..=steps).find(|&i| {
        let (a, b) = (speed(i - 1), speed(i));
        valid(a) && valid(b) && f(a) < 0.0 && f(b) >= 0.0
    })?;
    Some(bisect((speed(bracket - 1), speed(bracket)), |v| f(v) < 0.0))
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
