//! The fate of frames that are put into a mailbox of the CAN controller, which tries each of them once.

/// What the chip says of a mailbox.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mailbox {
    /// Nothing waits in it.
    pub empty: bool,
    /// The last frame left it, sent or not. Forgotten when the next is put in.
    pub completed: bool,
    /// That frame was sent, and another node took it.
    pub acknowledged: bool,
}

/// What to do with a mailbox when a new frame is due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Put the new frame in.
    Put,
    /// Take the old frame out, so that it does not go out late; the new one is dropped.
    Abort,
}

/// Frames since the start, wrapping.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Sent, and taken by another node.
    pub sent: u32,
    /// Dropped, aborted, or sent and not taken.
    pub lost: u32,
}

impl Counts {
    /// A new frame is due: counts the one before, and this one if it is dropped. Each frame is counted once.
    pub fn step(&mut self, mailbox: Mailbox) -> Action {
        if mailbox.completed && mailbox.acknowledged {
            self.sent = self.sent.wrapping_add(1);
        } else if mailbox.completed || !mailbox.empty {
            self.lost = self.lost.wrapping_add(1);
        }
        if mailbox.empty { Action::Put } else { Action::Abort }
    }
}
