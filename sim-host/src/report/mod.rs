//! What is told about results: figures and terminal plots.

pub mod figure;
pub mod terminal;
