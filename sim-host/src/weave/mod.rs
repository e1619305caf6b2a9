//! Recordings of the weave after a disturbance, in files: `record` reads one, `label` its name, and `measured` is the stored
//! table. The measurement itself is in the crate `analysis`, whose modules are passed on.

pub mod label;
pub mod measured;
pub mod record;

pub use analysis::weave::{Estimate, fit, noise, pool, predict, segment, shape, student, window};
