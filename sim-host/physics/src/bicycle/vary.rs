//! Changes some parameters of a bicycle.

use super::catalogue::Bicycle;
use super::combine::RIDER_KEYS;
use super::uncertain::{Measured, Uncertain};
use super::{KEYS, Parameters, check};

impl Bicycle {
    /// Sets the parameters given as `KEY=VALUE` in SI units; set values have no uncertainty.
    ///
    /// # Errors
    /// States the option, the key, the value and its range.
    pub fn varied(mut self, settings: &[String]) -> Result<Self, String> {
        let mut values = self.parameters.to_values();
        for setting in settings {
            let wrong = |error: String| format!("--bicycle-set {setting}: {error}");
            let (key, value) = setting.split_once('=').ok_or_else(|| wrong("expected KEY=VALUE".into()))?;
            let place = KEYS.iter().position(|k| *k == key);
            let place =
                place.ok_or_else(|| wrong(format!("no parameter `{key}`; there are {}", KEYS.join(", "))))?;
            values[place] = value.parse().map_err(|_| wrong(format!("`{value}` is not a number")))?;
            if let Some(Measured { bicycle, rider }) = &mut self.measured {
                if rider.is_some() && RIDER_KEYS.contains(&key) {
                    return Err(wrong("it combines frame and rider; change their files".into()));
                }
                bicycle[place] = Uncertain::exact(values[place]);
            }
        }
        if !settings.is_empty() {
            self.parameters = Parameters::from_values(&values);
            let name = format!("{} with {}", self.name, settings.join(", "));
            self.warnings.extend(check::check(&self.parameters).map_err(|error| format!("{name}: {error}"))?);
            self.warnings.dedup();
            self.name = name;
        }
        Ok(self)
    }
}
