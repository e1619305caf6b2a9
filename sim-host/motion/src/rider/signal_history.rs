//! The neural delay in steps of any length: the signals at the ends of the steps, interpolated.
//!
//! As in [`super::DelayLine`] the cubic through the four nearest signals never spans the delay, where the signal's second
//! derivative jumps. Later kinks are of higher order.

use std::collections::VecDeque;

/// Times that differ by less are the same \[s\].
const SAME_S: f64 = 1e-9;

/// Neural signals of one ride and their times.
#[derive(Clone, Debug)]
pub struct SignalHistory {
    delay_s: f64,
    /// Times \[s\] and signals \[N m\], oldest first.
    nodes: VecDeque<(f64, f64)>,
}

impl SignalHistory {
    /// No signals yet, for a delay above zero \[s\].
    pub fn new(delay_s: f64) -> Self {
        Self { delay_s, nodes: VecDeque::new() }
    }

    /// Clears all signals, for a new ride.
    pub fn clear(&mut self) {
        self.nodes.clear();
    }

    /// Stores the signal at the start of a step, `t` seconds after t = 0, and forgets those that no later step needs.
    pub fn push(&mut self, t: f64, signal: f64) {
        self.nodes.push_back((t, signal));
        while self.nodes.get(3).is_some_and(|node| node.0 <= t - self.delay_s) {
            self.nodes.pop_front();
        }
    }

    /// Replaces the latest signal.
    pub fn correct(&mut self, signal: f64) {
        if let Some(latest) = self.nodes.back_mut() {
            latest.1 = signal;
        }
    }

    /// The longest step from `t` that does not pass a multiple of the delay at which the arriving signal has a kink, and no
    /// longer than the delay \[s\].
    pub fn longest_step_s(&self, t: f64) -> f64 {
        let passed = ((t + SAME_S) / self.delay_s).floor();
        if passed < 2.0 { (passed + 1.0) * self.delay_s - t } else { self.delay_s }
    }

    /// The signals that arrive at start, middle and end of the step of `h` seconds from `t`, the time of the latest signal;
    /// zero before the delay has passed.
    pub fn arriving(&self, t: f64, h: f64) -> [f64; 3] {
        let sent = t - self.delay_s;
        if sent < -SAME_S {
            return [0.0; 3];
        }
        [0.0, 0.5, 1.0].map(|part| self.at(sent + part * h))
    }

    /// The signal at a past time \[s\], not before the oldest that is kept.
    pub fn at(&self, t: f64) -> f64 {
        let nodes = &self.nodes;
        let Some(last) = nodes.len().checked_sub(1) else { return 0.0 };
        let after = nodes.iter().position(|node| node.0 >= t).unwrap_or(last);
        let early = t < self.delay_s;
        let smooth = |i: usize| match early {
            true => nodes[i].0 <= self.delay_s + SAME_S,
            false => nodes[i].0 >= self.delay_s - SAME_S,
        };
        let lowest = (after.saturating_sub(3)..after).find(|&i| smooth(i)).unwrap_or(after);
        let highest = (after..=last.min(after + 2)).take_while(|&i| smooth(i)).last().unwrap_or(after);
        let from = after.saturating_sub(2).max(lowest).min((highest + 1).saturating_sub(4).max(lowest));
        let to = highest.min(from + 3);
        // Lagrange interpolation.
        let mut sum = 0.0;
        for (j, &(at, signal)) in nodes.range(from..=to).enumerate() {
            let (mut above, mut below) = (signal, 1.0);
            for (k, &(other, _)) in nodes.range(from..=to).enumerate() {
                if k != j {
                    (above, below) = (above * (t - other), below * (at - other));
                }
            }
            sum += above / below;
        }
        sum
    }
}
