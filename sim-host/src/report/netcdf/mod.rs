//! Results as NetCDF files that follow the CF conventions (<https://cfconventions.org>): every variable with units or the
//! meaning of its flags, every dimension with a coordinate.

mod active;
mod basin;
mod file;
mod plane;
mod ride;
mod variable;

pub use active::{ACTIVE, active_causes, active_limits, cause_names, limit_names, mode_names};
pub use basin::basin;
pub use file::{File, Format, NetCdfError, provenance};
pub use plane::plane;
pub use ride::ride;
pub use variable::{BOUND, Values, Variable, border_flags, effort_numbers, fall_flags, switch_flags};
