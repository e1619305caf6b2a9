//! The engineer's computer on the serial line: bytes to the board, each not before its time, and bytes from it.

use rigless::chip::Timeline;
use rigless::chip::uart::Peer;
use rigless::snapshot::Store;
use rigless::time::VirtualNanos;
use std::collections::VecDeque;

/// The far end of USART3.
#[derive(Debug, Default)]
pub struct Computer {
    to_board: VecDeque<(u64, u8)>,
    from_board: Vec<u8>,
}

impl Computer {
    /// Sends bytes one behind the other, the first not before this instant \[ns\]. The line's own speed is that of the
    /// board's baud rate register.
    pub fn send(&mut self, bytes: &[u8], from_ns: u64) {
        self.to_board.extend(bytes.iter().map(|byte| (from_ns, *byte)));
    }

    /// The bytes that came since the last call.
    pub fn take(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.from_board)
    }

    /// Bytes that are not on the line yet.
    pub fn waiting(&self) -> usize {
        self.to_board.len()
    }
}

/// Snapshots are not taken.
impl Store for Computer {}

impl Peer for Computer {
    fn receive(&mut self, word: u16, _: &mut Timeline<'_, '_>) {
        self.from_board.push(word as u8);
    }

    fn transmit(&mut self, now: VirtualNanos) -> Option<u16> {
        let (_, byte) = self.to_board.pop_front_if(|(from_ns, _)| *from_ns <= now.0)?;
        Some(byte.into())
    }
}
