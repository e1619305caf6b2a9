//! A board whose time advances only during an exchange with the host.

use super::BoardError;
use link::lockstep::{FromBoard, ToBoard};

/// A board in lockstep (`docs/pil.md`). Once created, it has done its first control step and waits for the host.
pub trait Lockstep {
    /// What the board sent last.
    fn last(&self) -> FromBoard<'_>;

    /// Sends `to` and receives what the board sends after its next control step; [`Lockstep::last`] returns it.
    ///
    /// # Errors
    /// The board has ended, or sends something that is no valid chunk.
    fn exchange(&mut self, to: &ToBoard<'_>) -> Result<(), BoardError>;
}
