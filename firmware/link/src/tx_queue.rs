//! Transmit queue: one ring of bytes for answers, and one for unsolicited messages.
//!
//! Never blocks. Telemetry that does not fit is dropped and counted. Answers have priority over telemetry; a frame
//! that is being sent is completed first.

use crate::frame::MAX_FRAME;
use crate::message::Message;
use crate::telemetry::Telemetry;
use heapless::Deque;

/// Queued frames, in rings of the given sizes \[bytes\].
#[derive(Debug)]
pub struct TxQueue<const ANSWERS: usize, const UNSOLICITED: usize> {
    answers: Deque<u8, ANSWERS>,
    unsolicited: Deque<u8, UNSOLICITED>,
    /// Ring of the frame being sent.
    sending: Sending,
    /// Control steps per telemetry message; 0 for none.
    divisor: u16,
    /// Control steps until the next telemetry message.
    steps_left: u16,
    sequence: u16,
    dropped: u32,
}

/// Ring of the frame being sent. A frame is sent whole: its first 0 begins it, its second one ends it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sending {
    Nothing,
    Answer { begun: bool },
    Unsolicited { begun: bool },
}

impl<const ANSWERS: usize, const UNSOLICITED: usize> TxQueue<ANSWERS, UNSOLICITED> {
    /// An empty queue that sends telemetry of one control step in `divisor`, none if that is 0.
    pub const fn new(divisor: u16) -> Self {
        Self {
            answers: Deque::new(),
            unsolicited: Deque::new(),
            sending: Sending::Nothing,
            divisor,
            steps_left: 0,
            sequence: 0,
            dropped: 0,
        }
    }

    /// Number of frames dropped for lack of space since the start, wrapping. Their sequence numbers are missing.
    pub fn dropped(&self) -> u32 {
        self.dropped
    }

    /// Queues an answer to the request of this sequence number; `false` if it does not fit before more is sent.
    pub fn answer(&mut self, message: &Message<'_>, sequence: u16) -> bool {
        push(&mut self.answers, message, sequence)
    }

    /// Queues an unsolicited message, or drops it.
    pub fn send(&mut self, message: &Message<'_>) {
        let queued = push(&mut self.unsolicited, message, self.sequence);
        self.sequence = self.sequence.wrapping_add(1);
        self.dropped = self.dropped.wrapping_add(u32::from(!queued));
    }

    /// Call at every control step: queues the telemetry of one step in `divisor`.
    pub fn step(&mut self, telemetry: &Telemetry) {
        if self.divisor == 0 {
            return;
        }
        if self.steps_left == 0 {
            self.send(&Message::Telemetry(*telemetry));
            self.steps_left = self.divisor;
        }
        self.steps_left -= 1;
    }

    /// Next byte for the line; `None` if the queue is empty.
    pub fn next_byte(&mut self) -> Option<u8> {
        if self.sending == Sending::Nothing {
            self.sending = match (self.answers.is_empty(), self.unsolicited.is_empty()) {
                (false, _) => Sending::Answer { begun: false },
                (true, false) => Sending::Unsolicited { begun: false },
                (true, true) => return None,
            };
        }
        let (byte, begun) = match &mut self.sending {
            Sending::Nothing => return None,
            Sending::Answer { begun } => (self.answers.pop_front()?, begun),
            Sending::Unsolicited { begun } => (self.unsolicited.pop_front()?, begun),
        };
        match (byte, *begun) {
            (0, true) => self.sending = Sending::Nothing,
            (0, false) => *begun = true,
            _ => {}
        }
        Some(byte)
    }
}

/// Appends a frame to a ring, whole or not at all.
fn push<const N: usize>(ring: &mut Deque<u8, N>, message: &Message<'_>, sequence: u16) -> bool {
    let mut bytes = [0; MAX_FRAME];
    let frame = message.encode(sequence, &mut bytes).and_then(|used| bytes.get(..used));
    match frame {
        Some(frame) if frame.len() <= N - ring.len() => {
            frame.iter().all(|byte| ring.push_back(*byte).is_ok())
        }
        _ => false,
    }
}
