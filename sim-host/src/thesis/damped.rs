//! Fits of a damped oscillation to a response (appendix C).

use super::simplex::minimum;
use std::ops::RangeInclusive;

/// Samples of a signal: time \[s\] and value.
pub type Samples = [(f64, f64)];

/// What a fit says of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitted {
    /// Real part of the eigenvalue \[1/s\]: `-beta` or `-gamma`.
    pub real: f64,
    /// Imaginary part \[rad/s\]: `omega`; 0 of a capsize fit.
    pub imaginary: f64,
    /// Root-mean-square residual as a part of the signal's root mean square.
    pub residual: f64,
}

/// What bounds the parameters of a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    /// `omega` \[rad/s\].
    pub omega: RangeInclusive<f64>,
    /// `beta` \[1/s\].
    pub beta: RangeInclusive<f64>,
}

/// Eq. C.1, `(A sin(omega t) + B cos(omega t)) exp(-beta t) + E`, from plain ones, E from zero.
pub fn oscillation(samples: &Samples) -> Fitted {
    let found = minimum([1.0, 1.0, 1.0, 1.0, 0.0], |p| squares(samples, |t| damped(p, t)));
    fitted(samples, -found[3], found[2].abs(), |t| damped(&found, t))
}

/// The same within bounds, from their middle; amplitudes within twice the signal's largest value.
pub fn bounded(samples: &Samples, bounds: &Bounds) -> Fitted {
    let peak = samples.iter().fold(0.0_f64, |m, s| m.max(s.1.abs()));
    let clamped = |[a, b, omega, beta, e]: &[f64; 5]| {
        let within = |x: &f64, r: &RangeInclusive<f64>| x.clamp(*r.start(), *r.end());
        let amplitude = |x: &f64| x.clamp(-2.0 * peak, 2.0 * peak);
        [amplitude(a), amplitude(b), within(omega, &bounds.omega), within(beta, &bounds.beta), amplitude(e)]
    };
    let middle = |r: &RangeInclusive<f64>| 0.5 * (r.start() + r.end());
    let start = [peak, peak, middle(&bounds.omega), middle(&bounds.beta), 0.0];
    let model = |p: &[f64; 5], t: f64| damped(&clamped(p), t);
    let found = clamped(&patiently(samples, start, model));
    fitted(samples, -found[3], found[2], |t| damped(&found, t))
}

/// Eq. C.2, `D exp(-gamma t)`, for capsize.
pub fn decay(samples: &Samples) -> Fitted {
    let model = |[d, gamma]: &[f64; 2], t: f64| d * (-gamma * t).exp();
    let peak = samples.iter().fold(0.0_f64, |m, s| m.max(s.1.abs()));
    let found = patiently(samples, [peak, 1.0], model);
    fitted(samples, -found[1], 0.0, |t| model(&found, t))
}

/// A simplex search begun anew from its result, on the residual as a part of the signal: the
/// tolerances then do not depend on how small the signal is, as those of `fmincon` do not.
fn patiently<const N: usize>(
    samples: &Samples,
    start: [f64; N],
    model: impl Fn(&[f64; N], f64) -> f64,
) -> [f64; N] {
    let size = squares(samples, |_| 0.0).max(f64::MIN_POSITIVE);
    let part = |p: &[f64; N]| 1e3 * squares(samples, |t| model(p, t)) / size;
    (0..5).fold(start, |from, _| minimum(from, part))
}

fn damped([a, b, omega, beta, e]: &[f64; 5], t: f64) -> f64 {
    let (s, c) = (omega * t).sin_cos();
    (a * s + b * c) * (-beta * t).exp() + e
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

    /// SciPy's Nelder-Mead, with the same start, tolerances and evaluations, ends at the same wrong
    /// place; with patience the right one is found.
    #[test]
    fn an_oscillation_is_missed_as_elsewhere_and_found_with_patience() {
        let signal = |t: f64| ((1.2 * t).sin() + 0.8 * (1.2 * t).cos()) * (-0.9 * t).exp() + 0.1;
        let samples: Vec<_> = (0..300).map(|i| 0.02 * f64::from(i)).map(|t| (t, signal(t))).collect();
        let fit = oscillation(&samples);
        assert!((fit.imaginary - 0.95970007).abs() < 1e-6 && (fit.real + 1.75235535).abs() < 1e-6, "{fit:?}");
        let within = bounded(&samples, &Bounds { omega: 0.0..=3.0, beta: 0.0..=2.0 });
        assert!((within.real + 0.9).abs() < 1e-3 && within.residual < 1e-3, "{within:?}");
    }
}
