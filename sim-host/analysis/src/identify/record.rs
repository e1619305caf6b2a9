//! A perturbation record at equal intervals, as the fit needs it.

use super::response::{Disturbances, Signal};

/// A measured signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// What was measured.
    pub signal: Signal,
    /// Its value at each sample \[rad or rad/s\].
    pub values: Vec<f64>,
    /// Whether the value is fitted: values in gaps and after unknown disturbances are not.
    pub valid: Vec<bool>,
}

/// Disturbances and the measured response.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Lateral force and steer torque disturbance.
    pub disturbances: Disturbances,
    /// The response, in at least one signal.
    pub measured: Vec<Measured>,
}

impl Record {
    /// The number of samples.
    pub fn len(&self) -> usize {
        self.disturbances.samples.len()
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The first `length` samples.
    pub(super) fn first(&self, length: usize) -> Self {
        let mut first = self.clone();
        first.disturbances.samples.truncate(length);
        for measured in &mut first.measured {
            measured.values.truncate(length);
            measured.valid.truncate(length);
        }
        first
    }

    /// Duration \[s\].
    pub fn duration_s(&self) -> f64 {
        self.len() as f64 * self.disturbances.sample_s
    }

    /// The samples within `after_s` of the start of a perturbation: of the first sample with a disturbance after one
    /// without.
    pub fn after_onsets(&self, after_s: f64) -> Vec<bool> {
        let disturbed = |sample: &[f64; 2]| sample.iter().any(|x| *x != 0.0);
        let (samples, reach) = (&self.disturbances.samples, after_s / self.disturbances.sample_s);
        let mut since = f64::INFINITY;
        let mut before = true;
        let mut within = Vec::with_capacity(samples.len());
        for sample in samples {
            let now = disturbed(sample);
            since = if now && !before { 0.0 } else { since + 1.0 };
            before = now;
            within.push(since <= reach);
        }
        within
    }
}
