//! Counts sent and lost frames of a CAN transmit mailbox that tries each frame once.

/// Status of a transmit mailbox, as the chip reports it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mailbox {
    /// No frame is pending.
    pub empty: bool,
    /// The last request has completed, sent or not. Cleared by the next request.
    pub completed: bool,
    /// That frame was sent and acknowledged by another node.
    pub acknowledged: bool,
}

/// Action on the mailbox when a new frame is due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Load the new frame.
    Put,
    /// Abort the pending frame, so that it is not sent late; the new frame is dropped.
    Abort,
}

/// Frame counters since the start, wrapping.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Sent and acknowledged.
    pub sent: u32,
    /// Dropped, aborted, or not acknowledged.
    pub lost: u32,
}

impl Counts {
    /// Called when a new frame is due: counts the previous frame, and the new one if it is dropped. Each frame counts
    /// once.
    pub fn step(&mut self, mailbox: Mailbox) -> Action {
        if mailbox.completed && mailbox.acknowledged {
            self.sent = self.sent.wrapping_add(1);
        } else if mailbox.completed || !mailbox.empty {
            self.lost = self.lost.wrapping_add(1);
        }
        if mailbox.empty { Action::Put } else { Action::Abort }
    }
}
