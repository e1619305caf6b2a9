//! What the flight cards in `tests/tests/` share; the cards themselves are the tests.

pub mod basins;

pub mod cli;
pub mod derived;
pub mod draws;
pub mod estimator_inputs;
pub mod fake_board;
pub mod fault_cards;
pub mod flow;
pub mod inside;
pub mod json_schema;
pub mod knock;
pub mod late;
pub mod linearised;
pub mod link_board;
pub mod model;
pub mod newton_euler;
pub mod noticed;
pub mod pil;
#[cfg(unix)]
pub mod pty;
pub mod published;
pub mod riders;
pub mod rides;
pub mod sets;
pub mod tape;
pub mod wait;
