//! Spectrum of one window: the modified periodogram (Welch 1967) with Hann's window, after removing the
//! linear trend.

use realfft::RealFftPlanner;
use std::f64::consts::PI;

/// Power density over frequency.
pub(super) struct Spectrum {
    /// Frequency resolution \[Hz\].
    step_hz: f64,
    /// One-sided density at the multiples of the resolution \[unit^2/Hz\].
    density: Vec<f64>,
    /// Standard deviation about the linear trend.
    pub(super) deviation: f64,
}

impl Spectrum {
    /// From samples with the period `period_s`.
    pub(super) fn new(values: &[f64], period_s: f64) -> Self {
        let n = values.len();
        let middle = 0.5 * (n as f64 - 1.0);
        let mean = values.iter().sum::<f64>() / n as f64;
        let along: f64 = values.iter().zip(0..).map(|(x, i)| x * (f64::from(i) - middle)).sum();
        let slope = along / (n as f64 * (n as f64 * n as f64 - 1.0) / 12.0);
        let rest: Vec<f64> =
            values.iter().zip(0..).map(|(x, i)| x - mean - slope * (f64::from(i) - middle)).collect();
        let deviation = (rest.iter().map(|x| x * x).sum::<f64>() / n as f64).sqrt();
        let hann = |i: usize| libm::sin(PI * (i as f64 + 0.5) / n as f64).powi(2);
        let weight: f64 = (0..n).map(|i| hann(i).powi(2)).sum();
        let transform = RealFftPlanner::<f64>::new().plan_fft_forward(n);
        let mut shaded: Vec<f64> = rest.iter().enumerate().map(|(i, x)| x * hann(i)).collect();
        let mut lines = transform.make_output_vec();
        let done = transform.process(&mut shaded, &mut lines);
        let density = lines.iter().map(|line| 2.0 * period_s * line.norm_sqr() / weight).collect();
        Self {
            step_hz: 1.0 / (n as f64 * period_s),
            density: if done.is_ok() { density } else { Vec::new() },
            deviation,
        }
    }

    /// Densities from one frequency to below another \[Hz\].
    fn between(&self, from_hz: f64, to_hz: f64) -> impl Iterator<Item = f64> {
        let at = |hz: f64| ((hz / self.step_hz).ceil() as usize).min(self.density.len());
        self.density[at(from_hz)..at(to_hz).max(at(from_hz))].iter().copied()
    }

    /// Mean density from one frequency to below another; NaN if there is none \[unit^2/Hz\].
    pub(super) fn mean(&self, from_hz: f64, to_hz: f64) -> f64 {
        let (sum, count) = self.between(from_hz, to_hz).fold((0.0, 0), |(sum, n), x| (sum + x, n + 1));
        sum / f64::from(count)
    }

    /// Power from one frequency to below another \[unit^2\].
    pub(super) fn power(&self, from_hz: f64, to_hz: f64) -> f64 {
        self.step_hz * self.between(from_hz, to_hz).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sinusoid of amplitude 2 has a power of 2 at its frequency and none an octave away; a linear trend
    /// has no power.
    #[test]
    fn a_sinusoid_keeps_its_power() {
        let values: Vec<f64> =
            (0..200).map(|i| 3.0 + 0.1 * f64::from(i) + 2.0 * libm::sin(0.31 * f64::from(i))).collect();
        let spectrum = Spectrum::new(&values, 0.005);
        let hz = 0.31 / (2.0 * PI * 0.005);
        assert!(
            (spectrum.power(hz - 4.0, hz + 4.0) - 2.0).abs() < 0.02,
            "{}",
            spectrum.power(hz - 4.0, hz + 4.0)
        );
        assert!(spectrum.power(2.0 * hz, 100.1) < 1e-4);
        assert!((spectrum.deviation - 2.0_f64.sqrt()).abs() < 0.02);
    }
}
