//! Comparison of a computed signal with the one in the recording.

use schemars::JsonSchema;
use serde::Serialize;

/// Two signals over the same instants.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Compared {
    /// Number of instants compared.
    pub count: u64,
    /// Root mean square of the difference.
    pub rms_difference: f64,
    /// Largest magnitude of the difference.
    pub largest_difference: f64,
    /// Root mean square of the computed signal, and of the recorded one.
    pub rms: [f64; 2],
    /// Correlation; null if one signal is constant.
    pub correlation: Option<f64>,
}

/// Sums from which the comparison is computed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Comparison {
    count: f64,
    difference: f64,
    largest: f64,
    sums: [f64; 2],
    squares: [f64; 2],
    product: f64,
}

impl Comparison {
    /// Adds one instant: computed and recorded value.
    pub(super) fn take(&mut self, ours: f64, theirs: f64) {
        let difference = ours - theirs;
        self.count += 1.0;
        self.difference += difference * difference;
        self.largest = self.largest.max(difference.abs());
        self.sums = [self.sums[0] + ours, self.sums[1] + theirs];
        self.squares = [self.squares[0] + ours * ours, self.squares[1] + theirs * theirs];
        self.product += ours * theirs;
    }

    /// The comparison; `None` without instants.
    pub(super) fn done(&self) -> Option<Compared> {
        let n = self.count;
        if n == 0.0 {
            return None;
        }
        let [mean_a, mean_b] = self.sums.map(|sum| sum / n);
        let variance = |i: usize, mean: f64| (self.squares[i] / n - mean * mean).max(0.0);
        let spread = (variance(0, mean_a) * variance(1, mean_b)).sqrt();
        Some(Compared {
            count: n as u64,
            rms_difference: (self.difference / n).sqrt(),
            largest_difference: self.largest,
            rms: self.squares.map(|square| (square / n).sqrt()),
            correlation: (spread > 1e-12).then(|| (self.product / n - mean_a * mean_b) / spread),
        })
    }
}

/// The newest value of a recorded signal at `t_s`, at most a quarter of a second old.
pub(super) fn held(signal: &[(f64, f64)], next: &mut usize, t_s: f64) -> Option<f64> {
    const OLD_S: f64 = 0.25;
    while signal.get(*next).is_some_and(|(at_s, _)| *at_s <= t_s + 1e-9) {
        *next += 1;
    }
    let (at_s, value) = signal.get(next.checked_sub(1)?)?;
    (t_s - at_s <= OLD_S).then_some(*value)
}
