//! A parameter set with its origin.

use super::Parameters;
use super::uncertain::Measured;

/// A parameter set and its origin.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Bicycle {
    /// Name, or `FILE` or `FILE#NAME` as given.
    pub name: String,
    /// Origin of the values, from the file.
    pub source: Option<String>,
    /// Remark from the file.
    pub note: Option<String>,
    /// Whether the rear frame includes a rider's body; `None` if the file does not state it.
    pub rider_included: Option<bool>,
    /// Doubtful but accepted values.
    pub warnings: Vec<String>,
    /// The values with their uncertainties, if the file has any.
    pub measured: Option<Measured>,
    /// The values.
    pub parameters: Parameters,
}
