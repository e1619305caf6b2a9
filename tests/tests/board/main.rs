//! The tools for a board, on a board made of the `link` crate.

mod client;
mod damage;
mod monitor;
#[cfg(unix)]
mod partial;
mod program;
mod texts;
mod tune;
