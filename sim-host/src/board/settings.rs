//! The settings of a board, and the requested ones.

use super::client::{Client, ClientError};
use super::parameter::{Parameter, ValueError, law_points};
use crate::parameters::Value;
use control::{Config, Law};
use link::page::{PAGE_BYTES, fill};
use std::collections::BTreeMap;

/// A parameter's value, or the law.
#[derive(Clone, Debug, PartialEq)]
pub enum Setting {
    /// The whole law.
    Law(Box<Law>),
    /// A parameter.
    Value {
        /// Its name.
        key: String,
        /// Its value; `None` is a disabled limit.
        value: Option<f32>,
    },
}

impl Setting {
    /// The key that it sets.
    pub fn key(&self) -> &str {
        match self {
            Setting::Law(_) => "law",
            Setting::Value { key, .. } => key,
        }
    }

    /// Writes it to the board.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn apply(&self, client: &mut Client) -> Result<(), ClientError> {
        match self {
            Setting::Law(law) => client.set_law(law).map(drop),
            Setting::Value { key, value } => client.set(key, *value).map(drop),
        }
    }
}

/// The settings of a board.
pub struct Settings {
    /// The law.
    pub law: Law,
    /// Its parameters, those of the law first.
    pub parameters: Vec<Parameter>,
}

/// Settings that a board cannot have: all errors.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))]
pub struct SettingsError(pub Vec<ValueError>);

impl Settings {
    /// Reads all settings of the board.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn read(client: &mut Client) -> Result<Self, ClientError> {
        Ok(Self { law: client.law()?, parameters: client.list()? })
    }

    /// Those of the flashed configuration, as a board without stored ones has them.
    pub fn flashed() -> Self {
        let config = Config::product();
        let mut parameters: Vec<Parameter> = Vec::new();
        loop {
            let mut room = [0; PAGE_BYTES];
            let page = fill(&config, &config, parameters.len() as u16, &mut room);
            parameters.extend(page.entries().map(Parameter::from));
            if page.count == 0 || parameters.len() >= usize::from(page.total) {
                return Self { law: config.law, parameters };
            }
        }
    }

    /// The parameters without those of the law.
    pub fn but_law(&self) -> impl Iterator<Item = &Parameter> {
        self.parameters.iter().filter(|one| one.key != "law" && !one.key.starts_with("law."))
    }

    /// All of them as settings.
    pub fn all(&self) -> Vec<Setting> {
        let value = |one: &Parameter| Setting::Value { key: one.key.clone(), value: one.value };
        std::iter::once(Setting::Law(self.law.clone().into())).chain(self.but_law().map(value)).collect()
    }

    /// The settings of a file: a law, and values by key.
    ///
    /// # Errors
    /// All errors: keys that the board does not have, values that are not allowed.
    pub fn understand(
        &self,
        law: Option<&Law>,
        values: &BTreeMap<String, Value>,
    ) -> Result<Vec<Setting>, SettingsError> {
        let mut wanted: Vec<_> = law.map(|law| Setting::Law(law.clone().into())).into_iter().collect();
        let mut wrong = Vec::new();
        for (key, value) in values {
            let known = self.but_law().find(|one| one.key == *key);
            match known
                .ok_or_else(|| ValueError::NoParameter(key.clone()))
                .and_then(|one| one.parse(&value.to_string()))
            {
                Ok(value) => wanted.push(Setting::Value { key: key.clone(), value }),
                Err(error) => wrong.push(error),
            }
        }
        if wrong.is_empty() { Ok(wanted) } else { Err(SettingsError(wrong)) }
    }

    /// Whether the board has this setting, bit for bit.
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

    /// The value of a key as text.
    pub fn words(&self, key: &str) -> String {
        match law_points(&self.law) {
            Some(points) if key == "law" => format!("table of {} points", points.len()),
            None if key == "law" => self.law.to_string(),
            _ => self.find(key).map_or("nothing".into(), |one| one.text(one.value)),
        }
    }
}
