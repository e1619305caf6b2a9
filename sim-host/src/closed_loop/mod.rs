//! Recordings of a closed loop, in files: `record` takes what the identification needs from a recording's samples, `stated`
//! is the law that a controller's source states. The identification is in the crate `analysis`, whose module is passed on.

mod record;
mod stated;

pub use analysis::closed_loop::*;
pub use record::{Lacking, geometry, record, within};
pub use stated::{Compared, StatedError, StatedLaw};
