//! What a board said.

use link::frame::Frame;
use link::message::{Message, NoMessage};

/// Kinds from here on are said unasked.
const UNASKED: u8 = 0xa0;

/// A frame from a board, kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReceivedMessage {
    /// Its number.
    pub sequence: u16,
    kind: u8,
    payload: Vec<u8>,
}

impl ReceivedMessage {
    /// Keeps a frame.
    pub fn new(frame: &Frame<'_>) -> Self {
        Self { sequence: frame.sequence, kind: frame.kind, payload: frame.payload.into() }
    }

    /// Whether the board says that unasked.
    pub fn is_unasked(frame: &Frame<'_>) -> bool {
        frame.kind >= UNASKED
    }

    /// What it says.
    ///
    /// # Errors
    /// As of [`Message::decode`].
    pub fn message(&self) -> Result<Message<'_>, NoMessage> {
        let Self { sequence, kind, payload } = self;
        Message::decode(&Frame { kind: *kind, sequence: *sequence, payload })
    }
}
