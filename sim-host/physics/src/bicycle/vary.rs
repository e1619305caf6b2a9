//! Changes some parameters of a bicycle.

use super::check::check;
use super::combine::RIDER_KEYS;
use super::error::VariationError;
use super::set::Bicycle;
use super::uncertain::{Measured, Uncertain};
use super::{KEYS, Parameters};
use std::collections::BTreeMap;

impl Bicycle {
    /// Sets the parameters with these keys, SI units; set values have no uncertainty.
    ///
    /// # Errors
    /// The key, the value and its range.
    pub fn varied(mut self, settings: &BTreeMap<String, f64>) -> Result<Self, VariationError> {
        let mut values = self.parameters.to_values();
        for (key, value) in settings {
            let place = KEYS.iter().position(|k| k == key);
            let place = place.ok_or_else(|| VariationError::Key(key.clone()))?;
            values[place] = *value;
            if let Some(Measured { bicycle, rider }) = &mut self.measured {
                if rider.is_some() && RIDER_KEYS.contains(&&**key) {
                    return Err(VariationError::Combined { key: key.clone(), value: *value });
                }
                bicycle[place] = Uncertain::exact(*value);
            }
        }
        if !settings.is_empty() {
            self.parameters = Parameters::from_values(&values);
            let settings: Vec<String> =
                settings.iter().map(|(key, value)| format!("{key}={value}")).collect();
            let name = format!("{} with {}", self.name, settings.join(", "));
            match check(&self.parameters) {
                Ok(warnings) => self.warnings.extend(warnings),
                Err(error) => return Err(VariationError::Parameter { name, error }),
            }
            self.warnings.dedup();
            self.name = name;
        }
        Ok(self)
    }
}
