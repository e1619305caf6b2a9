//! What a law reads that is sampled and held: on average over its period the signals of an earlier time, by their slopes and curvatures
//! over time, which follow from the values at the stages of a step.

use crate::integrate::STAGES;
use crate::num::{Lanes, Scalar};

/// Roll rate and speed as such a law reads them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held<S> {
    /// Slopes at the start of the step \[rad/s^2, m/s^2\], and 1 if they are known there, otherwise 0.
    slopes: [S; 2],
    known: S,
    /// Difference from the signals at the end of the last step.
    difference: [S; 2],
    /// The signals at the start of the step, and in its middle.
    start: [S; 2],
    middle: [S; 2],
}

impl<S: Scalar> Held<S> {
    /// Of a ride that begins.
    pub(super) fn unknown() -> Self {
        let none = [S::constant(0.0); 2];
        Self { slopes: none, known: S::constant(0.0), difference: none, start: none, middle: none }
    }

    /// What is read at a stage of the step of `h` seconds by a law with a period of twice `half_s` \[s\], to second order: by the parabola
    /// through the values at the start, in the middle and at the end or, in the middle, through those up to then with the slope at the
    /// start.
    #[inline(always)]
    pub(super) fn stage(&mut self, stage: usize, h: S, half_s: f64, (rate, speed): (S, S)) -> (S, S) {
        let signals = [rate, speed];
        if stage == 0 {
            self.start = signals;
            return (rate + self.difference[0], speed + self.difference[1]);
        }
        let per_s = S::constant(1.0) / h;
        let [first, second] = [per_s * half_s, per_s * per_s * (half_s * half_s * (2.0 / 3.0))];
        let at_end = stage == STAGES.len() - 1;
        let mut read = signals;
        for (i, signal) in signals.into_iter().enumerate() {
            let change = signal - self.start[i];
            // Per step.
            let (slope, curvature) = if at_end {
                let second_half = (signal - self.middle[i]) * 4.0;
                (second_half - change, (second_half - change - change) * 2.0)
            } else {
                let mean = change * 2.0;
                let bend = (mean - self.slopes[i] * h) * self.known;
                (mean + bend, bend * 4.0)
            };
            let difference = curvature * second - slope * first;
            if at_end {
                (self.slopes[i], self.difference[i]) = (slope * per_s, difference);
            }
            read[i] = signal + difference;
        }
        self.middle = signals;
        if at_end {
            self.known = S::constant(1.0);
        }
        (read[0], read[1])
    }
}

impl<const N: usize> Held<Lanes<N>> {
    /// Those of a lane.
    pub(super) fn lane(&self, lane: usize) -> Held<f64> {
        let two = |signals: &[Lanes<N>; 2]| [signals[0].0[lane], signals[1].0[lane]];
        Held {
            slopes: two(&self.slopes),
            known: self.known.0[lane],
            difference: two(&self.difference),
            start: two(&self.start),
            middle: two(&self.middle),
        }
    }

    /// Sets those of a lane between two steps.
    pub(super) fn set_lane(&mut self, lane: usize, to: &Held<f64>) {
        for i in 0..2 {
            self.slopes[i].0[lane] = to.slopes[i];
            self.difference[i].0[lane] = to.difference[i];
        }
        self.known.0[lane] = to.known;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HALF_S: f64 = 0.5e-3;

    /// The mean of a signal over the instants at which a law reads it that holds what it reads for twice [`HALF_S`].
    fn mean(signal: impl Fn(f64) -> f64, t: f64) -> f64 {
        (0..1000).map(|i| signal(t - (f64::from(i) + 0.5) * 2e-3 * HALF_S)).sum::<f64>() / 1000.0
    }

    /// Situation: signals that are parabolas of time, in steps of different lengths. Action: read them at the stages. Must hold: their
    /// means over a period but in the first step before its end, where nothing, and then the mean slope alone, is known.
    #[test]
    fn parabolas_are_read_exactly() {
        let signal = |t: f64| 2.0 + 3.0 * t - 5.0 * t * t;
        let (mut held, mut t) = (Held::<f64>::unknown(), 0.0);
        for (step, h) in [0.01, 0.02, 0.005].into_iter().enumerate() {
            for (stage, part) in STAGES.into_iter().enumerate() {
                let at = t + part * h;
                let (read, mirrored) = held.stage(stage, h, HALF_S, (signal(at), -signal(at)));
                let expected = match (step, stage) {
                    (0, 0) => signal(at),
                    (0, 1 | 2) => signal(at) - HALF_S * (3.0 - 10.0 * 0.25 * h),
                    _ => mean(signal, at),
                };
                assert!(
                    (read - expected).abs() < 1e-11,
                    "step {step}, stage {stage}: {read}, not {expected}"
                );
                assert_eq!(mirrored, -read);
            }
            t += h;
        }
    }

    /// Situation: a signal that grows and sways. Action: read it in steps as long as the period. Must hold: its mean within 1e-8, while
    /// the signal half a period earlier differs from the present one by more than 0.001.
    #[test]
    fn a_growing_signal_is_read_as_its_mean() {
        let signal = |t: f64| libm::exp(3.0 * t) * libm::sin(20.0 * t);
        let (mut held, mut t, h) = (Held::<f64>::unknown(), 0.1, 2.0 * HALF_S);
        let mut read = 0.0;
        for _ in 0..10 {
            for (stage, part) in STAGES.into_iter().enumerate() {
                read = held.stage(stage, h, HALF_S, (signal(t + part * h), 0.0)).0;
            }
            t += h;
        }
        assert!((read - mean(signal, t)).abs() < 1e-8, "{read} {}", mean(signal, t));
        assert!((read - signal(t)).abs() > 1e-3, "{read} {}", signal(t));
    }
}
