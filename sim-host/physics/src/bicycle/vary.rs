//! Changes some parameters of a bicycle.

use super::catalogue::Bicycle;
use super::combine::RIDER_KEYS;
use super::uncertain::{Measured, Uncertain};
use super::{KEYS, Parameters, check};
use std::collections::BTreeMap;

impl Bicycle {
    /// Sets the parameters with these keys, SI units; set values have no uncertainty.
    ///
    /// # Errors
    /// States the key, the value and its range.
    pub fn varied(mut self, settings: &BTreeMap<String, f64>) -> Result<Self, String> {
        let mut values = self.parameters.to_values();
        for (key, value) in settings {
            let place = KEYS.iter().position(|k| k == key);
            let place =
                place.ok_or_else(|| format!("no parameter `{key}`; there are {}", KEYS.join(", ")))?;
            values[place] = *value;
            if let Some(Measured { bicycle, rider }) = &mut self.measured {
                if rider.is_some() && RIDER_KEYS.contains(&&**key) {
                    return Err(format!("`{key}` combines frame and rider; change their files"));
                }
                bicycle[place] = Uncertain::exact(*value);
            }
        }
        if !settings.is_empty() {
            self.parameters = Parameters::from_values(&values);
            let settings: Vec<String> =
                settings.iter().map(|(key, value)| format!("{key}={value}")).collect();
            let name = format!("{} with {}", self.name, settings.join(", "));
            self.warnings.extend(check::check(&self.parameters).map_err(|error| format!("{name}: {error}"))?);
            self.warnings.dedup();
            self.name = name;
        }
        Ok(self)
    }
}
