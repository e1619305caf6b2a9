//! Questions answered by a computation.

mod balance_assist;
mod delay;
mod weave;
