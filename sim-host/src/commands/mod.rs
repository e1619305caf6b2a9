//! The commands without their command line: from a scenario or a recording to a document, one file per command.
//!
//! A long command reports its progress and can be stopped through [`Hooks`]; what is finished then is its result.

pub mod basin;
pub mod drawn;
pub mod eigen;
mod error;
pub mod identify;
pub mod identify_text;
pub mod linear_loop;
pub mod plane;
pub mod replay;
pub mod ride;
mod setup;
pub mod sweep;

pub use error::CommandError;
pub use setup::Setup;

/// Callbacks of a long command, for progress and interruption, called from several threads.
#[derive(Clone, Copy)]
pub struct Hooks<'a> {
    /// Called after every part of the work: a speed, a ray, a cell.
    pub finished: &'a (dyn Fn() + Sync),
    /// Called with a number of parts that are added to the work.
    pub added: &'a (dyn Fn(usize) + Sync),
    /// Checked before every part; true ends the command with what is finished.
    pub stop: &'a (dyn Fn() -> bool + Sync),
}
