//! A bicycle with some parameters changed.

use super::catalogue::Bicycle;
use super::combine::RIDER_KEYS;
use super::uncertain::{Measured, Uncertain};
use super::{KEYS, Parameters, check};

impl Bicycle {
    /// The same with parameters as `KEY=VALUE` says, SI units; what is set has no uncertainty.
    ///
    /// # Errors
    /// Names what is wrong: the word, the key, the value and its range.
    pub fn varied(mut self, words: &[String]) -> Result<Self, String> {
        let mut values = self.parameters.to_values();
        for word in words {
            let wrong = |why: String| format!("--bicycle-set {word}: {why}");
            let (key, value) = word.split_once('=').ok_or_else(|| wrong("expected KEY=VALUE".into()))?;
            let place = KEYS.iter().position(|k| *k == key);
            let place =
                place.ok_or_else(|| wrong(format!("no parameter `{key}`; there are {}", KEYS.join(", "))))?;
            values[place] = value.parse().map_err(|_| wrong(format!("`{value}` is not a number")))?;
            if let Some(Measured { bicycle, rider }) = &mut self.measured {
                if rider.is_some() && RIDER_KEYS.contains(&key) {
                    return Err(wrong(
                        "it is of the frame and the rider together; change their files".into(),
                    ));
                }
                bicycle[place] = Uncertain::exact(values[place]);
            }
        }
        if !words.is_empty() {
            self.parameters = Parameters::from_values(&values);
            let name = format!("{} with {}", self.name, words.join(", "));
            self.warnings.extend(check::check(&self.parameters).map_err(|why| format!("{name}: {why}"))?);
            self.warnings.dedup();
            self.name = name;
        }
        Ok(self)
    }
}
