//! A board whose time stands still while it waits for the host.

use super::BoardError;
use link::lockstep::{FromBoard, ToBoard};

/// A board in lockstep (`docs/pil.md`). It has stepped once when it is there, and waits for the host.
pub trait Lockstep {
    /// What it handed over last.
    fn last(&self) -> FromBoard<'_>;

    /// Hands over to it, and takes what it hands over after its next control step, as [`Lockstep::last`].
    ///
    /// # Errors
    /// It is gone, or says what means nothing.
    fn exchange(&mut self, to: &ToBoard<'_>) -> Result<(), BoardError>;
}
