//! Fits of a damped oscillation to a response (appendix C).

use crate::simplex::minimum;
use nalgebra::{Matrix3, Vector3};
use std::ops::RangeInclusive;

/// Samples of a signal: time \[s\] and value.
pub type Samples = [(f64, f64)];

/// Result of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitted {
    /// Real part of the eigenvalue \[1/s\]: `-beta` or `-gamma`.
    pub real: f64,
    /// Imaginary part \[rad/s\]: `omega`; 0 for a capsize fit.
    pub imaginary: f64,
    /// Root-mean-square residual relative to the signal's root mean square.
    pub residual: f64,
}

/// Bounds of a fit's parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    /// `omega` \[rad/s\].
    pub omega: RangeInclusive<f64>,
    /// `beta` \[1/s\].
    pub beta: RangeInclusive<f64>,
}

/// Fits eq. C.1, `(A sin(omega t) + B cos(omega t)) exp(-beta t) + E`, from initial values of 1, and 0 for E.
pub fn oscillation(samples: &Samples) -> Fitted {
    let found = minimum([1.0, 1.0, 1.0, 1.0, 0.0], |p| squares(samples, |t| damped(p, t)));
    fitted(samples, -found[3], found[2].abs(), |t| damped(&found, t))
}

/// Fits eq. C.1 with `omega` and `beta` within bounds: the best point of a grid, then the simplex method. `A`, `B` and
/// `E`, which enter linearly, are computed by least squares at every step.
pub fn bounded(samples: &Samples, bounds: &Bounds) -> Fitted {
    const CELLS: u32 = 12;
    let within = |x: f64, r: &RangeInclusive<f64>| x.clamp(*r.start(), *r.end());
    let clamped = |[omega, beta]: &[f64; 2]| (within(*omega, &bounds.omega), within(*beta, &bounds.beta));
    let size = squares(samples, |_| 0.0).max(f64::MIN_POSITIVE);
    // Relative to the signal, so that the search's tolerances do not depend on its amplitude.
    let part = |p: &[f64; 2]| {
        let (omega, beta) = clamped(p);
        let waves = waves(samples, omega, beta);
        let [a, b, e] = amplitudes(samples, &waves);
        let rest = samples.iter().zip(&waves).map(|(&(_, y), [s, c])| (y - (a * s + b * c + e)).powi(2));
        1e3 * rest.sum::<f64>() / size
    };
    let at = |r: &RangeInclusive<f64>, i: u32| {
        r.start() + (r.end() - r.start()) * (f64::from(i) + 0.5) / f64::from(CELLS)
    };
    let cells = (0..CELLS * CELLS).map(|i| [at(&bounds.omega, i / CELLS), at(&bounds.beta, i % CELLS)]);
    let valued = cells.map(|p| (p, part(&p)));
    let start = valued.min_by(|p, q| p.1.total_cmp(&q.1)).map_or([0.0; 2], |(p, _)| p);
    let (omega, beta) = clamped(&minimum(start, part));
    let [a, b, e] = amplitudes(samples, &waves(samples, omega, beta));
    let found = [a, b, omega, beta, e];
    fitted(samples, -found[3], found[2], |t| damped(&found, t))
}

/// The damped sine and cosine at each sample.
fn waves(samples: &Samples, omega: f64, beta: f64) -> Vec<[f64; 2]> {
    let at = |&(t, _): &(f64, f64)| {
        let ((s, c), decay) = (libm::sincos(omega * t), libm::exp(-beta * t));
        [s * decay, c * decay]
    };
    samples.iter().map(at).collect()
}

/// The amplitudes `A`, `B`, `E` of these waves and a constant by least squares; zeros if there is no solution.
fn amplitudes(samples: &Samples, waves: &[[f64; 2]]) -> [f64; 3] {
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (&(_, y), &[s, c]) in samples.iter().zip(waves) {
        let row = Vector3::new(s, c, 1.0);
        normal += row * row.transpose();
        right += row * y;
    }
    normal.svd(true, true).solve(&right, 1e-12).map_or([0.0; 3], Into::into)
}

/// Fits eq. C.2, `D exp(-gamma t)`, a capsize mode.
pub fn decay(samples: &Samples) -> Fitted {
    let model = |[d, gamma]: &[f64; 2], t: f64| d * libm::exp(-gamma * t);
    let peak = samples.iter().fold(0.0_f64, |m, s| m.max(s.1.abs()));
    let size = squares(samples, |_| 0.0).max(f64::MIN_POSITIVE);
    let found = minimum([peak, 1.0], |p| 1e3 * squares(samples, |t| model(p, t)) / size);
    fitted(samples, -found[1], 0.0, |t| model(&found, t))
}

fn damped([a, b, omega, beta, e]: &[f64; 5], t: f64) -> f64 {
    let (s, c) = libm::sincos(omega * t);
    (a * s + b * c) * libm::exp(-beta * t) + e
}

fn squares(samples: &Samples, model: impl Fn(f64) -> f64) -> f64 {
    samples.iter().map(|&(t, y)| (y - model(t)).powi(2)).sum()
}

fn fitted(samples: &Samples, real: f64, imaginary: f64, model: impl Fn(f64) -> f64) -> Fitted {
    let size = squares(samples, |_| 0.0).max(f64::MIN_POSITIVE);
    Fitted { real, imaginary, residual: (squares(samples, model) / size).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// SciPy's Nelder-Mead, with the same start, tolerances and evaluations, ends at the same wrong point; with bounds
    /// the correct one is found.
    #[test]
    fn an_oscillation_is_missed_as_elsewhere_and_found_within_bounds() {
        let signal = |t: f64| (libm::sin(1.2 * t) + 0.8 * libm::cos(1.2 * t)) * libm::exp(-0.9 * t) + 0.1;
        let samples: Vec<_> = (0..300).map(|i| 0.02 * f64::from(i)).map(|t| (t, signal(t))).collect();
        let fit = oscillation(&samples);
        assert!((fit.imaginary - 0.95970007).abs() < 1e-6 && (fit.real + 1.75235535).abs() < 1e-6, "{fit:?}");
        let within = bounded(&samples, &Bounds { omega: 0.0..=3.0, beta: 0.0..=2.0 });
        assert!((within.real + 0.9).abs() < 1e-3 && within.residual < 1e-3, "{within:?}");
    }
}
