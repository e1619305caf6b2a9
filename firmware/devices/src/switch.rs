//! Debounce of a switch.

/// Debounced state of a switch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Switch {
    closed: bool,
    /// Number of consecutive control periods in which the contact differs from `closed`.
    otherwise: u16,
}

impl Switch {
    /// One control period: `closed` is the present contact, `ticks` the number of consecutive periods after which a
    /// change is accepted. Returns the debounced state.
    pub fn step(&mut self, closed: bool, ticks: u16) -> bool {
        self.otherwise = if closed == self.closed { 0 } else { self.otherwise.saturating_add(1) };
        if self.otherwise >= ticks.max(1) {
            (self.closed, self.otherwise) = (closed, 0);
        }
        self.closed
    }
}
