//! A message received from a board.

use link::frame::Frame;
use link::message::{Message, NoMessage};

/// Kinds from this number on are unsolicited.
const UNSOLICITED: u8 = 0xa0;

/// A frame from a board, copied.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReceivedMessage {
    /// Its sequence number.
    pub sequence: u16,
    kind: u8,
    payload: Vec<u8>,
}

impl ReceivedMessage {
    /// Copies a frame.
    pub fn new(frame: &Frame<'_>) -> Self {
        Self { sequence: frame.sequence, kind: frame.kind, payload: frame.payload.into() }
    }

    /// Whether the board sends this frame unsolicited.
    pub fn is_unsolicited(frame: &Frame<'_>) -> bool {
        frame.kind >= UNSOLICITED
    }

    /// The decoded message.
    ///
    /// # Errors
    /// See [`Message::decode`].
    pub fn message(&self) -> Result<Message<'_>, NoMessage> {
        let Self { sequence, kind, payload } = self;
        Message::decode(&Frame { kind: *kind, sequence: *sequence, payload })
    }
}
