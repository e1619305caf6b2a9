//! Perturbation records of real or simulated riders: from a recording to equal intervals, as an identification needs them.

mod doubts;
mod error;
mod outliers;
mod uniform;

pub use error::RecordError;
pub use uniform::{Prepared, Settings, prepare};
