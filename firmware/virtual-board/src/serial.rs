//! The host on the serial line: timed bytes to the board, and bytes from it.

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
    /// Queues bytes, the first not before this time \[ns\]. The speed is that of the board's baud rate register.
    pub fn send(&mut self, bytes: &[u8], from_ns: u64) {
        self.to_board.extend(bytes.iter().map(|byte| (from_ns, *byte)));
    }

    /// Bytes received since the last call.
    pub fn take(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.from_board)
    }

    /// Number of queued bytes.
    pub fn waiting(&self) -> usize {
        self.to_board.len()
    }
}

/// Snapshots are unused.
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
