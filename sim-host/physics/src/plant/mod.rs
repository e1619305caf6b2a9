//! The plant between bicycle and controller: its models (crate `motion`) and the files that describe them.

pub mod catalogue;
pub mod sensor_file;

pub use motion::plant::*;
