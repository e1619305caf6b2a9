//! Questions answered by a computation.

mod balance_assist;
mod delay;
mod equal_vaf;
mod weave;
