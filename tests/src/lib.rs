//! Code shared by the tests in `tests/tests/`.

pub mod basins;

pub mod cli;
pub mod closed_loop;
pub mod count;
pub mod derived;
pub mod detection;
pub mod draws;
pub mod estimator_inputs;
pub mod fake_board;
pub mod fault_reactions;
pub mod flow;
pub mod identification;
pub mod inside;
pub mod json_schema;
pub mod knock;
pub mod late;
pub mod linearised;
pub mod link_board;
pub mod model;

pub mod pil;
#[cfg(unix)]
pub mod pty;
pub mod published;
pub mod python;
pub mod riders;
pub mod rides;
pub mod sets;
pub mod tape;
pub mod wait;
