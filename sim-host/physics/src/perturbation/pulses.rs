//! Pulses at random times, to both sides.

use super::PerturbationError;
use crate::num::RandomStream;
use crate::range::within;

/// Rectangular pulses of one amplitude and duration, each to the right or to the left with equal probability.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Pulses {
    /// Amplitude, in the unit of what is pulsed; 0 for none.
    pub amplitude: f64,
    /// Duration of a pulse \[s\], rounded to whole samples.
    pub duration_s: f64,
    /// Mean time from the end of a pulse to the start of the next \[s\]; uniformly distributed from half to one and a half
    /// times it, so that the rider cannot know when. The first pulse comes after one such time.
    pub interval_s: f64,
}

impl Pulses {
    pub(super) fn check(&self, name: &str, most: f64) -> Result<(), PerturbationError> {
        within(name, self.amplitude, 0.0, most)?;
        within(&format!("{name}: duration of a pulse (s)"), self.duration_s, 0.001, 60.0)?;
        Ok(within(&format!("{name}: interval of the pulses (s)"), self.interval_s, 0.01, 600.0)?)
    }

    /// The value at `n` samples, `sample_s` apart, each held until the next. The times do not depend on the amplitude.
    pub(super) fn values(&self, mut stream: RandomStream, sample_s: f64, n: usize) -> Vec<f64> {
        let length = ((self.duration_s / sample_s).round() as usize).max(1);
        let mut values = vec![0.0; n];
        let mut at = 0;
        loop {
            let pause_s = self.interval_s * (0.5 + stream.uniform());
            let side = if stream.chance(0.5) { 1.0 } else { -1.0 };
            at += ((pause_s / sample_s).round() as usize).max(1);
            let Some(rest) = values.get_mut(at..).filter(|rest| !rest.is_empty()) else { return values };
            rest.iter_mut().take(length).for_each(|value| *value = side * self.amplitude);
            at += length;
        }
    }
}
