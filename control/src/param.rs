//! What is wrong with a parameter: its name, its value and the range it may have.

use core::fmt;

/// A parameter outside its range. `value` may be NaN or infinite, as given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParamError {
    /// The parameter's dotted name, unit included.
    pub name: &'static str,
    /// The value given.
    pub value: f32,
    /// Least allowed value.
    pub min: f32,
    /// Largest allowed value.
    pub max: f32,
}

impl fmt::Display for ParamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {} is outside {} to {}", self.name, self.value, self.min, self.max)
    }
}

impl core::error::Error for ParamError {}

/// Accepts `value` when `min <= value <= max`; NaN never is.
pub(crate) fn check(name: &'static str, value: f32, min: f32, max: f32) -> Result<(), ParamError> {
    if value >= min && value <= max { Ok(()) } else { Err(ParamError { name, value, min, max }) }
}
