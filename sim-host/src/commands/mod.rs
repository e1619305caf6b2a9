//! The commands without their command line: from a scenario or a recording to a document, one file per command.
//!
//! A long command tells its progress and can be stopped through [`Hooks`]; what is finished then is its result.

pub mod basin;
pub mod drawn;
pub mod eigen;
mod error;
pub mod identify;
pub mod identify_text;
pub mod plane;
pub mod replay;
pub mod ride;
mod setup;
pub mod sweep;

pub use error::CommandError;
pub use setup::Setup;

/// What a long command tells, and asks, while it computes. The functions are called from several threads.
#[derive(Clone, Copy)]
pub struct Hooks<'a> {
    /// Called after every part of the work: a speed, a ray, a cell.
    pub finished: &'a (dyn Fn() + Sync),
    /// Called with a number of parts that are added to the work.
    pub added: &'a (dyn Fn(usize) + Sync),
    /// Asked before every part; true ends the command with what is finished.
    pub stop: &'a (dyn Fn() -> bool + Sync),
}
