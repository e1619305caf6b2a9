//! A delay in steps of any length, the rider's neural one or that of a law: the signals at the ends of the steps, interpolated.
//!
//! As in [`super::DelayLine`] the cubic through the four nearest signals never spans the time at which the first signal arrives,
//! where the signal has a kink, or a jump from another source. Later kinks are of higher order.

use std::collections::VecDeque;

/// Signals of one ride and their times.
#[derive(Clone, Debug)]
pub struct SignalHistory {
    delay_s: f64,
    /// Time at which the first signal arrives \[s\].
    first_s: f64,
    /// Time of a jump of the signal \[s\]; infinite if there is none.
    jump_s: f64,
    /// Times \[s\] and signals \[N m\], oldest first.
    nodes: VecDeque<(f64, f64)>,
}

impl SignalHistory {
    /// Times that differ by less are the same \[s\].
    pub const SAME_S: f64 = 1e-9;

    /// No signals yet, for a delay above zero \[s\].
    pub fn new(delay_s: f64) -> Self {
        Self::arriving_from(delay_s, delay_s)
    }

    /// The same with a first signal that arrives already at `first_s`, no later than its delay, and stays until then.
    pub fn arriving_from(first_s: f64, delay_s: f64) -> Self {
        Self { delay_s, first_s, jump_s: f64::INFINITY, nodes: VecDeque::new() }
    }

    /// The same of a signal that jumps at once after `jump_s` \[s\].
    pub fn with_jump(self, jump_s: f64) -> Self {
        Self { jump_s, ..self }
    }

    /// Clears all signals, for a new ride.
    pub fn clear(&mut self) {
        self.nodes.clear();
    }

    /// Stores the signal at the start of a step, `t` seconds after t = 0, and forgets those that neither the step before nor a later
    /// one needs.
    pub fn push(&mut self, t: f64, signal: f64) {
        let before = self.nodes.back().map_or(0.0, |node| node.0);
        self.nodes.push_back((t, signal));
        while self.nodes.get(3).is_some_and(|node| node.0 <= before - self.delay_s) {
            self.nodes.pop_front();
        }
    }

    /// Replaces the latest signal.
    pub fn correct(&mut self, signal: f64) {
        if let Some(latest) = self.nodes.back_mut() {
            latest.1 = signal;
        }
    }

    /// The longest step from `t` that does not pass a time at which the arriving signal has a kink, and no longer than the delay
    /// \[s\].
    pub fn longest_step_s(&self, t: f64) -> f64 {
        self.kink_s(t).min(self.delay_s)
    }

    /// The time from `t` to the next at which the arriving signal has a kink \[s\]; infinite after the last.
    pub fn kink_s(&self, t: f64) -> f64 {
        let Self { delay_s, first_s, jump_s, .. } = *self;
        let kinks_s = [first_s, delay_s, first_s + delay_s, jump_s, jump_s + delay_s];
        let left_s = kinks_s.into_iter().map(|kink_s| kink_s - t).filter(|left_s| *left_s > Self::SAME_S);
        left_s.fold(f64::INFINITY, f64::min)
    }

    /// The signals that arrive at start, middle and end of the step of `h` seconds from `t`, the time of the latest signal;
    /// zero before the first one arrives.
    #[inline(always)]
    pub fn arriving(&self, t: f64, h: f64) -> [f64; 3] {
        [self.arriving_after(t, 0.0), self.arriving_after(t, 0.5 * h), self.arriving_after(t, h)]
    }

    /// The signal that arrives `elapsed_s` after the start `t` of a step.
    #[inline(always)]
    pub fn arriving_after(&self, t: f64, elapsed_s: f64) -> f64 {
        if t < self.first_s - Self::SAME_S {
            return 0.0;
        }
        // A step that ends with a jump is before it, one that begins with it after.
        let before_jump = t - self.delay_s < self.jump_s - Self::SAME_S;
        self.interpolated((t + elapsed_s - self.delay_s).max(0.0), before_jump)
    }

    /// The same after the latest signal, if a later one is `next`: its time \[s\] and signal \[N m\].
    pub fn arriving_before(&mut self, next: (f64, f64), t: f64, elapsed_s: f64) -> f64 {
        self.nodes.push_back(next);
        let signal = self.arriving_after(t, elapsed_s);
        self.nodes.pop_back();
        signal
    }

    /// The signal at a past time \[s\], not before the oldest that is kept.
    pub fn at(&self, t: f64) -> f64 {
        self.interpolated(t, t <= self.jump_s)
    }

    /// The same from nodes before a jump or after it.
    #[inline(always)]
    fn interpolated(&self, t: f64, before_jump: bool) -> f64 {
        let nodes = &self.nodes;
        let Some(last) = nodes.len().checked_sub(1) else { return 0.0 };
        let after = nodes.iter().position(|node| node.0 >= t).unwrap_or(last);
        // The kink belongs to both sides, the jump to the earlier one.
        let smooth = |i: usize| {
            let node = nodes[i].0;
            let by_kink = if t < self.first_s {
                node <= self.first_s + Self::SAME_S
            } else {
                node >= self.first_s - Self::SAME_S
            };
            by_kink && before_jump == (node < self.jump_s + Self::SAME_S)
        };
        // The usual case. The nodes are in order: between two smooth ones all are.
        if after >= 2 && last >= 3 {
            let from = (after - 2).min(last - 3);
            if smooth(from) && smooth(from + 3) {
                return lagrange(&std::array::from_fn::<_, 4, _>(|i| nodes[from + i]), t);
            }
        }
        let lowest =
            (after.saturating_sub(4)..after).rev().take_while(|&i| smooth(i)).last().unwrap_or(after);
        let highest = (after..=last.min(after + 2)).take_while(|&i| smooth(i)).last();
        let highest = highest.unwrap_or(after.saturating_sub(1).max(lowest));
        let from = after.saturating_sub(2).max(lowest).min((highest + 1).saturating_sub(4).max(lowest));
        let to = highest.min(from + 3);
        let mut some = [(0.0, 0.0); 4];
        some.iter_mut().zip(nodes.range(from..=to)).for_each(|(to, node)| *to = *node);
        lagrange(&some[..=to - from], t)
    }
}

/// The polynomial through some nodes, by Lagrange's interpolation.
#[inline(always)]
fn lagrange(nodes: &[(f64, f64)], t: f64) -> f64 {
    let mut sum = 0.0;
    for (j, &(at, signal)) in nodes.iter().enumerate() {
        let (mut above, mut below) = (signal, 1.0);
        for (k, &(other, _)) in nodes.iter().enumerate() {
            if k != j {
                (above, below) = (above * (t - other), below * (at - other));
            }
        }
        sum += above / below;
    }
    sum
}
