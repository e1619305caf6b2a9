//! The options that the cells of a study's sweep share, as a table or as text.

use super::error::PartError;
use crate::parameters::Value;
use crate::scenario::setting::{CONDITIONS, SEARCH, Setting};
use serde::Deserialize;
use std::collections::BTreeMap;

/// The options that all cells of a sweep share.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged, expecting = "a table of options, or options as text")]
pub enum StudyOptions {
    /// Values by the name of the option; a list for an option that may be repeated.
    Table(BTreeMap<String, OptionValue>),
    /// As on the command line.
    Text(String),
}

/// The value of an option, or several.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged, expecting = "a number, text, or a list of them")]
pub enum OptionValue {
    /// One.
    One(Value),
    /// Several.
    Several(Vec<Value>),
}

impl StudyOptions {
    /// The settings and their texts, in the order of the table of settings; `None` for options as text.
    ///
    /// # Errors
    /// An unknown option, or several values of one that can't be repeated.
    pub fn settings(&self) -> Result<Option<Vec<(&'static Setting, String)>>, PartError> {
        let Self::Table(table) = self else { return Ok(None) };
        let all = || [CONDITIONS, SEARCH].into_iter().flatten();
        if let Some(name) = table.keys().find(|name| !all().any(|setting| setting.name == **name)) {
            let names: Vec<_> = all().map(|setting| setting.name).collect();
            return Err(PartError::Option { name: name.clone(), known: names.join(", ") });
        }
        let mut found = Vec::new();
        for setting in all() {
            match table.get(setting.name) {
                None => {}
                Some(OptionValue::One(value)) => found.push((setting, value.to_string())),
                Some(OptionValue::Several(_)) if !setting.repeats => {
                    return Err(PartError::Once(setting.name));
                }
                Some(OptionValue::Several(values)) => {
                    found.extend(values.iter().map(|value| (setting, value.to_string())));
                }
            }
        }
        Ok(Some(found))
    }

    /// As typed on the command line.
    pub fn typed(&self) -> String {
        match (self, self.settings()) {
            (Self::Text(text), _) => text.clone(),
            (_, Ok(Some(settings))) => {
                let options = settings.iter().map(|(setting, text)| format!("--{} {text}", setting.name));
                options.collect::<Vec<_>>().join(" ")
            }
            (_, _) => String::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::parse;

    #[test]
    fn options_as_a_table_are_typed_in_the_order_of_the_settings() {
        let part = |options: &str| {
            let text = format!(
                "title='t'\nquestion='q'\n[[sweep]]\nname='a'\ntitle='t'\noptions={options}\nover=['law=h,f']\n\
                 reference={{law='h'}}\nalong='law'\n"
            );
            parse("s", &text).unwrap().parts.remove(0).options
        };
        let table =
            part("{ scan-step = 0.5, speeds = '2:7:1', torque-limit = 7, set = ['a.b=on', 'c={d}'] }");
        assert_eq!(table.typed(), "--torque-limit 7 --set a.b=on --set c={d} --speeds 2:7:1 --scan-step 0.5");
        let text = part("'--law h --speeds 4'");
        assert_eq!((text.typed(), text.settings().unwrap().is_none()), ("--law h --speeds 4".into(), true));
    }
}
