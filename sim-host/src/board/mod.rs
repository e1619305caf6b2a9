//! A board at the other end of a line: asked, tuned and watched with the same `link` crate that it is built with.

pub mod causes;
pub mod client;
pub mod exception;
pub mod fault;
pub mod line;
pub mod monitor;
pub mod parameter;
pub mod recorded;
pub mod requests;
pub mod row;
pub mod serial;
pub mod settings;
pub mod told;
pub mod tune;

pub use client::{Client, ClientError, Patience};
pub use line::{Line, LineError};
pub use requests::BoardName;
