//! A parameter set with its origin.

use super::Parameters;
use super::check::check;
use super::error::SetError;
use super::uncertain::Measured;

/// A parameter set and its origin.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bicycle {
    /// Name, or `FILE` or `FILE#NAME` as given.
    pub name: String,
    /// Origin of the values, from the file.
    #[serde(default)]
    pub source: Option<String>,
    /// Remark from the file.
    #[serde(default)]
    pub note: Option<String>,
    /// Whether the rear frame includes a rider's body; `None` if the file does not state it.
    #[serde(default)]
    pub rider_included: Option<bool>,
    /// Doubtful but accepted values.
    #[serde(default)]
    pub warnings: Vec<String>,
    /// The values with their uncertainties, if the file has any.
    #[serde(default)]
    pub measured: Option<Measured>,
    /// The values.
    pub parameters: Parameters,
}

impl Bicycle {
    /// Checks a bicycle that does not come from a file, and adds the warnings that a file's would have.
    ///
    /// # Errors
    /// The parameter, its value and range, or values that contradict each other.
    pub fn checked(mut self) -> Result<Self, SetError> {
        if let Some(measured) = &self.measured
            && !(measured.is_complete() && measured.parameters() == self.parameters)
        {
            return Err(SetError::Measured);
        }
        for warning in check(&self.parameters)? {
            if !self.warnings.contains(&warning) {
                self.warnings.push(warning);
            }
        }
        Ok(self)
    }
}
