//! What the flight cards in `tests/tests/` share; the cards themselves are the tests.

pub mod newton_euler;
pub mod published;
