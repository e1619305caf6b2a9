//! Device side of a software SPI bus: from edges of three lines to words.

/// Clock edge, from idle low, at which the device samples a bit; it outputs its own at the other edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Take {
    Rising,
    Falling,
}

/// Meaning of an edge for the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Event {
    /// No meaning.
    None,
    /// Selected.
    Selected,
    /// Deselected.
    Released,
    /// Sample this bit.
    Bit(bool),
    /// Output the next bit.
    Next,
}

/// Previous levels of the lines.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lines {
    select: bool,
    clock: bool,
}

impl Lines {
    /// Idle lines.
    pub(super) const fn new() -> Self {
        Self { select: true, clock: false }
    }

    /// Whether the device is selected.
    pub(super) const fn is_selected(&self) -> bool {
        !self.select
    }

    /// Updates the lines, one edge at a time, as software does.
    pub(super) fn step(&mut self, take: Take, select: bool, clock: bool, data: bool) -> Event {
        let before = core::mem::replace(self, Self { select, clock });
        match (before.select, select) {
            (true, false) => Event::Selected,
            (false, true) => Event::Released,
            (true, true) => Event::None,
            (false, false) if before.clock == clock => Event::None,
            (false, false) if clock == (take == Take::Rising) => Event::Bit(data),
            (false, false) => Event::Next,
        }
    }
}
