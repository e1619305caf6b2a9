//! Flight cards: questions answered with a computation.

mod balance_assist;
mod delay;
mod weave;
