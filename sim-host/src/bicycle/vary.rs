//! Changes some parameters of a bicycle.

use super::check::check;
use super::combine::RIDER_KEYS;
use super::error::VariationError;
use super::set::Bicycle;
use super::uncertain::{Measured, Uncertain};
use super::{KEYS, Parameters};

impl Bicycle {
    /// Sets the parameters given as `KEY=VALUE` in SI units; set values have no uncertainty.
    ///
    /// # Errors
    /// States the option, the key, the value and its range.
    pub fn varied(mut self, settings: &[String]) -> Result<Self, VariationError> {
        let mut values = self.parameters.to_values();
        for setting in settings {
            let of = || setting.clone();
            let (key, value) = setting.split_once('=').ok_or_else(|| VariationError::Form(of()))?;
            let place = KEYS.iter().position(|k| *k == key);
            let place = place.ok_or_else(|| VariationError::Key { setting: of(), key: key.into() })?;
            let number = value.parse();
            values[place] =
                number.map_err(|_| VariationError::Number { setting: of(), value: value.into() })?;
            if let Some(Measured { bicycle, rider }) = &mut self.measured {
                if rider.is_some() && RIDER_KEYS.contains(&key) {
                    return Err(VariationError::Combined(of()));
                }
                bicycle[place] = Uncertain::exact(values[place]);
            }
        }
        if !settings.is_empty() {
            self.parameters = Parameters::from_values(&values);
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
