//! What a board has, and what it is wanted to have.

use super::client::{Client, ClientError};
use super::parameter::{Parameter, law_name, law_points};
use control::Law;

/// A parameter's value, or the law.
#[derive(Clone, Debug, PartialEq)]
pub enum Setting {
    /// The whole law.
    Law(Box<Law>),
    /// A parameter.
    Value {
        /// Its name.
        key: String,
        /// Its value; `None` is a limit that is off.
        value: Option<f32>,
    },
}

impl Setting {
    /// What it sets.
    pub fn key(&self) -> &str {
        match self {
            Setting::Law(_) => "law",
            Setting::Value { key, .. } => key,
        }
    }

    /// Sets it.
    ///
    /// # Errors
    /// As of [`ClientError`].
    pub fn apply(&self, client: &mut Client) -> Result<(), ClientError> {
        match self {
            Setting::Law(law) => client.set_law(law).map(drop),
            Setting::Value { key, value } => client.set(key, *value).map(drop),
        }
    }
}

/// What a board has.
pub struct Settings {
    /// The law.
    pub law: Law,
    /// Its parameters, those of the law first.
    pub parameters: Vec<Parameter>,
}

impl Settings {
    /// All that the board has.
    ///
    /// # Errors
    /// As of [`ClientError`].
    pub fn read(client: &mut Client) -> Result<Self, ClientError> {
        Ok(Self { law: client.law()?, parameters: client.list()? })
    }

    /// The parameters but for those that the law has.
    pub fn but_law(&self) -> impl Iterator<Item = &Parameter> {
        self.parameters.iter().filter(|one| one.key != "law" && !one.key.starts_with("law."))
    }

    /// All of it as settings.
    pub fn all(&self) -> Vec<Setting> {
        let value = |one: &Parameter| Setting::Value { key: one.key.clone(), value: one.value };
        std::iter::once(Setting::Law(self.law.clone().into())).chain(self.but_law().map(value)).collect()
    }

    /// The settings that words stand for: a law, and values by key.
    ///
    /// # Errors
    /// Everything that is wrong: keys that the board does not have, values that they may not be.
    pub fn understand(&self, law: Option<&Law>, values: &[(String, String)]) -> Result<Vec<Setting>, String> {
        let mut wanted: Vec<_> = law.map(|law| Setting::Law(law.clone().into())).into_iter().collect();
        let mut wrong = Vec::new();
        for (key, text) in values {
            let known = self.but_law().find(|one| one.key == *key);
            match known
                .ok_or_else(|| format!("the board has no parameter {key}"))
                .and_then(|one| one.parse(text))
            {
                Ok(value) => wanted.push(Setting::Value { key: key.clone(), value }),
                Err(why) => wrong.push(why),
            }
        }
        if wrong.is_empty() { Ok(wanted) } else { Err(wrong.join("; ")) }
    }

    /// Whether it has this, to the bit.
    pub fn has(&self, setting: &Setting) -> bool {
        match setting {
            Setting::Law(law) => self.law == **law,
            Setting::Value { key, value } => self.find(key).is_some_and(|one| one.has(*value)),
        }
    }

    /// A parameter by its key.
    pub fn find(&self, key: &str) -> Option<&Parameter> {
        self.parameters.iter().find(|one| one.key == key)
    }

    /// What a key has, in words.
    pub fn words(&self, key: &str) -> String {
        match law_points(&self.law) {
            Some(points) if key == "law" => format!("table of {} points", points.len()),
            None if key == "law" => law_name(&self.law),
            _ => self.find(key).map_or("nothing".into(), |one| one.text(one.value)),
        }
    }
}
