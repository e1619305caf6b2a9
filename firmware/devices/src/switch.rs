//! A switch without its bouncing.

/// A switch as it is believed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Switch {
    closed: bool,
    /// Control periods in a row in which it seemed to be otherwise.
    otherwise: u16,
}

impl Switch {
    /// One control period: what the contact seems to be now, and for how many periods in a row it must seem otherwise
    /// before that is believed.
    pub fn step(&mut self, closed: bool, ticks: u16) -> bool {
        self.otherwise = if closed == self.closed { 0 } else { self.otherwise.saturating_add(1) };
        if self.otherwise >= ticks.max(1) {
            (self.closed, self.otherwise) = (closed, 0);
        }
        self.closed
    }
}
