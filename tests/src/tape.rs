//! Record of all chunks exchanged between a board in lockstep and its host.

use link::lockstep::{FromBoard, MAX_CHUNK, ToBoard};
use sim_host::pil::{BoardError, Lockstep};

/// A board whose chunks are recorded.
pub struct Taped<B> {
    /// The board.
    pub board: B,
    /// The chunks of both directions, in order, from the board's first on.
    pub chunks: Vec<Vec<u8>>,
}

impl<B: Lockstep> Taped<B> {
    /// Of this board, which has just started.
    pub fn new(board: B) -> Self {
        let mut taped = Self { board, chunks: Vec::new() };
        taped.keep_last();
        taped
    }

    fn keep_last(&mut self) {
        let mut room = [0; MAX_CHUNK];
        let used = self.board.last().encode(&mut room).expect("a chunk holds it");
        self.chunks.push(room[..used].into());
    }
}

impl<B: Lockstep> Lockstep for Taped<B> {
    fn last(&self) -> FromBoard<'_> {
        self.board.last()
    }

    fn exchange(&mut self, to: &ToBoard<'_>) -> Result<(), BoardError> {
        let mut room = [0; MAX_CHUNK];
        let used = to.encode(&mut room).expect("a chunk holds it");
        self.chunks.push(room[..used].into());
        self.board.exchange(to)?;
        self.keep_last();
        Ok(())
    }
}
