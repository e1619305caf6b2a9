//! The neural delay: from the rider's feedback signals to the delayed signals that drive the neuromuscular
//! dynamics.
//!
//! Method of steps: the delay is a whole number of integration steps, so that each step of the delay equation
//! is one of an ordinary equation with a known input. Signals are stored at whole steps and interpolated
//! between by the cubic through the four nearest. The cubic never spans t = 0, where the disturbance makes
//! the signal jump, or a multiple of the delay, where that jump returns as a kink. The order therefore stays
//! that of the Runge-Kutta step.

use super::SignalHistory;

/// Delayed signals of one ride.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct DelayLine {
    /// The latest signals \[N m\], indexed by step modulo the ring's length, a power of two.
    ring: Vec<f64>,
    /// Delay in steps; at least 1.
    delay: usize,
    /// Number of signals stored so far.
    pushed: usize,
}

impl DelayLine {
    /// An empty delay line of `delay` steps, at least 1.
    pub fn new(delay: usize) -> Self {
        // The oldest signal needed is two steps older than the arriving one.
        Self { ring: vec![0.0; (delay + 4).next_power_of_two()], delay: delay.max(1), pushed: 0 }
    }

    /// Clears all signals, for a new ride.
    pub fn clear(&mut self) {
        self.pushed = 0;
    }

    /// Stores the signal at the start of the next step.
    #[inline(always)]
    pub fn push(&mut self, signal: f64) {
        let mask = self.ring.len() - 1;
        self.ring[self.pushed & mask] = signal;
        self.pushed += 1;
    }

    /// Replaces the latest signal.
    pub fn correct(&mut self, signal: f64) {
        self.pushed -= 1;
        self.push(signal);
    }

    /// The signals of the last delay and their times, for steps of `step_s` seconds.
    pub fn history(&self, step_s: f64) -> SignalHistory {
        let mut history = SignalHistory::new(self.delay as f64 * step_s);
        let mask = self.ring.len() - 1;
        for step in self.pushed.saturating_sub(self.ring.len())..self.pushed {
            history.push(step as f64 * step_s, self.ring[step & mask]);
        }
        history
    }

    /// The up to four signals from which this step's arrivals are interpolated: step of the first, their
    /// number, and the index of the one that arrives at the start; `None` before the delay has passed.
    #[inline(always)]
    fn nearest(&self) -> Option<(usize, usize, usize)> {
        let i = (self.pushed - 1).checked_sub(self.delay)?;
        let (first, last) = if self.delay < 3 {
            (0, self.pushed - 1)
        } else {
            let first = i - i % self.delay;
            (first, first + self.delay)
        };
        let from = i.saturating_sub(1).max(first).min((last + 1).saturating_sub(4).max(first));
        Some((from, (last - from + 1).min(4), i - from))
    }

    /// Signals that arrive at start, middle and end of the step that began with the latest stored signal;
    /// zero before the delay has passed.
    #[inline(always)]
    pub fn arriving(&self) -> [f64; 3] {
        let Some((from, count, place)) = self.nearest() else { return [0.0; 3] };
        let mask = self.ring.len() - 1;
        let at = |k: usize| self.ring[(from + k) & mask];
        let middle = match (count, place) {
            (4, 1) => (9.0 * (at(1) + at(2)) - (at(0) + at(3))) / 16.0,
            (4, 0) => (5.0 * at(0) + 15.0 * at(1) - 5.0 * at(2) + at(3)) / 16.0,
            (4, _) => (5.0 * at(3) + 15.0 * at(2) - 5.0 * at(1) + at(0)) / 16.0,
            _ => self.arriving_at(0.5),
        };
        [at(place), middle, at(place + 1)]
    }

    /// Signal that arrives at the fraction `s`, 0 to 1, of that step.
    pub fn arriving_at(&self, s: f64) -> f64 {
        let Some((from, count, place)) = self.nearest() else { return 0.0 };
        let (mask, at) = (self.ring.len() - 1, s + place as f64);
        // Lagrange interpolation.
        let weight = |j: usize| -> f64 {
            (0..count).filter(|&k| k != j).map(|k| (at - k as f64) / (j as f64 - k as f64)).product()
        };
        (0..count).map(|j| weight(j) * self.ring[(from + j) & mask]).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Arrivals at every half step, up to `steps`, of the signal `f` stored at 0, 1, ...
    fn delayed(delay: usize, steps: usize, f: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        let mut delay_line = DelayLine::new(delay);
        let mut out = Vec::new();
        for n in 0..steps {
            delay_line.push(f(n as f64));
            for (s, arrived) in [0.0, 0.5, 1.0].into_iter().zip(delay_line.arriving()) {
                assert!((delay_line.arriving_at(s) - arrived).abs() <= 1e-12 * arrived.abs().max(1.0));
                out.push((n as f64 + s - delay as f64, arrived));
            }
        }
        out
    }

    #[test]
    fn a_cubic_arrives_unchanged() {
        let f = |t: f64| 1.0 + 2.0 * t - 0.3 * t * t + 0.01 * t * t * t;
        for delay in [3, 4, 5, 30, 60, 61] {
            for (t, arrived) in delayed(delay, 4 * delay, f) {
                // A step that ends when the first signal arrives still receives zero.
                if t > 0.0 {
                    assert!(
                        (arrived - f(t)).abs() < 1e-11 * (1.0 + f(t).abs()),
                        "{delay} {t}: {arrived} {}",
                        f(t)
                    );
                } else if t < 0.0 {
                    assert_eq!(arrived, 0.0, "{delay} {t}");
                }
            }
        }
    }

    #[test]
    fn whole_steps_arrive_exactly() {
        let f = |t: f64| libm::sin(17.0 * t);
        for delay in [1, 2, 3, 7] {
            for (t, arrived) in
                delayed(delay, 30, f).into_iter().filter(|(t, _)| t.fract() == 0.0 && *t > 0.0)
            {
                assert_eq!(arrived, f(t), "{delay} {t}");
            }
        }
    }

    #[test]
    fn a_kink_after_one_delay_is_not_smeared() {
        let f = |t: f64| if t <= 10.0 { t } else { 10.0 - 3.0 * (t - 10.0) };
        for (t, arrived) in delayed(10, 40, f).into_iter().filter(|(t, _)| *t > 0.0 && *t <= 20.0) {
            assert!((arrived - f(t)).abs() < 1e-12, "{t}: {arrived}");
        }
    }

    #[test]
    fn a_new_ride_starts_from_nothing() {
        let mut delay_line = DelayLine::new(4);
        (0..20).for_each(|_| delay_line.push(1.0));
        assert_eq!(delay_line.arriving()[1], 1.0);
        delay_line.clear();
        delay_line.push(2.0);
        assert_eq!(delay_line.arriving()[2], 0.0);
        delay_line.correct(3.0);
        (0..4).for_each(|_| delay_line.push(0.0));
        assert_eq!(delay_line.arriving()[0], 3.0);
    }
}
