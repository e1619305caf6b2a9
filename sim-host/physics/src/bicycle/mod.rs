//! Bicycles: the equations of motion (crate `motion`), the files that hold their parameters, and their linear form.

pub mod catalogue;
mod check;
pub mod combine;
mod error;
mod extras;
mod formats;
pub mod linear;
pub mod onboard;
mod rider_body;
mod set;
pub mod uncertain;
mod vary;

pub use error::{FormatError, NumberError, ParameterError, SetError, VariationError};
pub use motion::bicycle::*;
