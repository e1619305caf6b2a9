//! A part's side of a serial bus that is moved by hand: edges of three lines to words.

/// The edge of the clock, low at rest, at which the part takes a bit; it puts its own out at the other one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Take {
    Rising,
    Falling,
}

/// What an edge means to the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Event {
    /// Nothing.
    None,
    /// It was selected.
    Selected,
    /// It was let go.
    Released,
    /// It takes this bit.
    Bit(bool),
    /// It is to put out the next bit.
    Next,
}

/// The lines as they were.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lines {
    select: bool,
    clock: bool,
}

impl Lines {
    /// At rest.
    pub(super) const fn new() -> Self {
        Self { select: true, clock: false }
    }

    /// Whether the part is selected.
    pub(super) const fn is_selected(&self) -> bool {
        !self.select
    }

    /// The lines as they are now; one edge at a time, as software makes them.
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
