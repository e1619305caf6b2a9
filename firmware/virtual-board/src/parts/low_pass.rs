//! Second-order Butterworth low-pass filter of three axes at a fixed sampling rate.

use std::f64::consts::{PI, SQRT_2};

/// Coefficients and state of the filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LowPass {
    /// Weights of the newest inputs, and of the previous outputs.
    inputs: [f64; 3],
    outputs: [f64; 2],
    /// The last two inputs and outputs of each axis; `None` before the first sample.
    before: Option<[[[f64; 2]; 2]; 3]>,
}

impl LowPass {
    /// Filter with a bandwidth (3 dB) at a sampling rate \[Hz\]; bilinear transform with prewarped bandwidth.
    pub(super) fn new(bandwidth_hz: f64, rate_hz: f64) -> Self {
        let k = (PI * bandwidth_hz / rate_hz).tan();
        let scale = 1.0 / (1.0 + SQRT_2 * k + k * k);
        Self {
            inputs: [k * k * scale, 2.0 * k * k * scale, k * k * scale],
            outputs: [2.0 * (k * k - 1.0) * scale, (1.0 - SQRT_2 * k + k * k) * scale],
            before: None,
        }
    }

    /// Filters the next sample; the initial state is the steady state of the first.
    pub(super) fn step(&mut self, values: [f64; 3]) -> [f64; 3] {
        let before = self.before.get_or_insert(values.map(|x| [[x; 2]; 2]));
        let mut filtered = [0.0; 3];
        for axis in 0..3 {
            let ([x1, x2], [y1, y2]) = (before[axis][0], before[axis][1]);
            let ([b0, b1, b2], [a1, a2]) = (self.inputs, self.outputs);
            let x = values[axis];
            filtered[axis] = b0 * x + b1 * x1 + b2 * x2 - a1 * y1 - a2 * y2;
            before[axis] = [[x, x1], [filtered[axis], y1]];
        }
        filtered
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Amplitude of a sine after the filter.
    fn gain(bandwidth_hz: f64, hz: f64) -> f64 {
        let mut filter = LowPass::new(bandwidth_hz, 1600.0);
        let at = |n: usize| (2.0 * PI * hz * n as f64 / 1600.0).sin();
        let out: Vec<f64> = (0..3200).map(|n| filter.step([at(n), 0.0, 1.0])[0]).collect();
        out[1600..].iter().map(|x| 2.0 * x * x / 1600.0).sum::<f64>().sqrt()
    }

    #[test]
    fn three_decibels_at_the_bandwidth_and_a_constant_as_it_is() {
        assert!((gain(254.6, 254.6) - 0.5_f64.sqrt()).abs() < 0.01);
        assert!((gain(254.6, 10.0) - 1.0).abs() < 1e-3);
        assert!((0.01..0.2).contains(&gain(254.6, 700.0)));
        let mut filter = LowPass::new(136.6, 1600.0);
        assert!((0..50).all(|_| (filter.step([9.8, 0.0, 0.0])[0] - 9.8).abs() < 1e-12));
    }
}
