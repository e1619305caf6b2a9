//! The thesis, computed again.

mod convergence;
mod report;
mod riders;
