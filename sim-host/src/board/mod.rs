//! A board at the other end of a line: asked, tuned and watched with the same `link` crate that it is built with.

pub mod client;
pub mod line;
pub mod recorded;
pub mod serial;
pub mod told;

pub use client::{Client, ClientError, Patience};
pub use line::{Line, LineError};
