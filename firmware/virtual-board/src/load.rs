//! Duration of the motor interrupt, measured from the end of the conversions to its last access to TIM1.

/// Calls of the motor interrupt so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Calls {
    /// Number of calls.
    pub count: u64,
    /// Total duration \[ns\].
    pub sum_ns: u64,
    /// Longest duration \[ns\].
    pub longest_ns: u64,
    began_ns: Option<u64>,
    last_ns: u64,
}

impl Calls {
    /// Handles the end of the conversions, which also ends the previous call.
    pub(crate) fn begin(&mut self, now_ns: u64) {
        if let Some(began_ns) = self.began_ns {
            let took_ns = self.last_ns.saturating_sub(began_ns);
            (self.count, self.sum_ns) = (self.count + 1, self.sum_ns + took_ns);
            self.longest_ns = self.longest_ns.max(took_ns);
        }
        (self.began_ns, self.last_ns) = (Some(now_ns), now_ns);
    }

    /// Handles an access to the timer.
    pub(crate) fn accessed(&mut self, now_ns: u64) {
        self.last_ns = now_ns;
    }

    /// Mean duration of a call \[us\].
    pub fn mean_us(&self) -> f64 {
        self.sum_ns as f64 * 1e-3 / self.count.max(1) as f64
    }
}
