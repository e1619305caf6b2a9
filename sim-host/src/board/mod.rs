//! A board at the other end of a line.

pub mod line;

pub use line::{Line, LineError};
