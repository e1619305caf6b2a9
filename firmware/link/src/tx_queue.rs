//! What waits to go out: a ring of bytes for answers and one for what nobody asked for.
//!
//! Nothing here ever waits. Telemetry that finds no room is dropped and counted; an answer never stands
//! behind telemetry, but for the frame that is just going out.

use crate::frame::MAX_FRAME;
use crate::message::Message;
use crate::telemetry::Telemetry;
use heapless::Deque;

/// Frames that wait, in rings of so many bytes.
#[derive(Debug)]
pub struct TxQueue<const ANSWERS: usize, const UNASKED: usize> {
    answers: Deque<u8, ANSWERS>,
    unasked: Deque<u8, UNASKED>,
    /// What the bytes going out now are from.
    going: Going,
    /// Steps between two that are told.
    divisor: u16,
    /// Steps until the next is told.
    wait: u16,
    sequence: u16,
    dropped: u32,
}

/// Which frame is going out. It goes out whole: its first 0 begins it, its second one ends it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Going {
    Nothing,
    Answer { begun: bool },
    Unasked { begun: bool },
}

impl<const ANSWERS: usize, const UNASKED: usize> TxQueue<ANSWERS, UNASKED> {
    /// Nothing waits; one control step of every `divisor` is told, none if that is 0.
    pub const fn new(divisor: u16) -> Self {
        Self {
            answers: Deque::new(),
            unasked: Deque::new(),
            going: Going::Nothing,
            divisor,
            wait: 0,
            sequence: 0,
            dropped: 0,
        }
    }

    /// Frames dropped because there was no room, since the start, wrapping. Their sequence numbers are missing.
    pub fn dropped(&self) -> u32 {
        self.dropped
    }

    /// Takes an answer to the request of this number; `false` if there is no room until more was sent.
    pub fn answer(&mut self, message: &Message<'_>, sequence: u16) -> bool {
        push(&mut self.answers, message, sequence)
    }

    /// Takes what nobody asked for, or drops it.
    pub fn tell(&mut self, message: &Message<'_>) {
        let told = push(&mut self.unasked, message, self.sequence);
        self.sequence = self.sequence.wrapping_add(1);
        self.dropped = self.dropped.wrapping_add(u32::from(!told));
    }

    /// To be called at every control step: tells one of as many as the divisor says.
    pub fn step(&mut self, telemetry: &Telemetry) {
        if self.divisor == 0 {
            return;
        }
        if self.wait == 0 {
            self.tell(&Message::Telemetry(*telemetry));
            self.wait = self.divisor;
        }
        self.wait -= 1;
    }

    /// The next byte for the line; `None` when nothing waits.
    pub fn next_byte(&mut self) -> Option<u8> {
        if self.going == Going::Nothing {
            self.going = match (self.answers.is_empty(), self.unasked.is_empty()) {
                (false, _) => Going::Answer { begun: false },
                (true, false) => Going::Unasked { begun: false },
                (true, true) => return None,
            };
        }
        let (byte, begun) = match &mut self.going {
            Going::Nothing => return None,
            Going::Answer { begun } => (self.answers.pop_front()?, begun),
            Going::Unasked { begun } => (self.unasked.pop_front()?, begun),
        };
        match (byte, *begun) {
            (0, true) => self.going = Going::Nothing,
            (0, false) => *begun = true,
            _ => {}
        }
        Some(byte)
    }
}

/// Puts a frame into a ring, whole or not at all.
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
