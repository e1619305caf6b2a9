//! How long the motor's interrupt takes, seen from outside: from the end of the conversions to its last access to TIM1.

/// The calls of the motor's interrupt so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Calls {
    /// How many.
    pub count: u64,
    /// Time of all together \[ns\].
    pub sum_ns: u64,
    /// The longest \[ns\].
    pub longest_ns: u64,
    began_ns: Option<u64>,
    last_ns: u64,
}

impl Calls {
    /// The conversions are over, and with them whatever the call before did.
    pub(crate) fn begin(&mut self, now_ns: u64) {
        if let Some(began_ns) = self.began_ns {
            let took_ns = self.last_ns.saturating_sub(began_ns);
            (self.count, self.sum_ns) = (self.count + 1, self.sum_ns + took_ns);
            self.longest_ns = self.longest_ns.max(took_ns);
        }
        (self.began_ns, self.last_ns) = (Some(now_ns), now_ns);
    }

    /// The timer was accessed.
    pub(crate) fn accessed(&mut self, now_ns: u64) {
        self.last_ns = now_ns;
    }

    /// Mean of a call \[us\].
    pub fn mean_us(&self) -> f64 {
        self.sum_ns as f64 * 1e-3 / self.count.max(1) as f64
    }
}
