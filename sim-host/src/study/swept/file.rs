//! A sweep study as defined in a TOML file.

use crate::parameters::Value;
use crate::scenario::setting::{CONDITIONS, SEARCH, Setting};
use crate::sweep::Axis;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A question and the sweeps that answer it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Study {
    /// Its name, equal to that of its files.
    #[serde(skip)]
    pub name: String,
    /// Title of the page.
    pub title: String,
    /// The question, and the method.
    pub question: String,
    /// Remarks below the answers.
    #[serde(default)]
    pub remarks: String,
    /// The sweeps.
    #[serde(rename = "sweep")]
    pub parts: Vec<Part>,
}

/// One sweep of a study and the evaluation of its result.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Its name, equal to that of its folder and figures.
    pub name: String,
    /// Title above its answer.
    pub title: String,
    /// Text before its answer.
    #[serde(default)]
    pub text: String,
    /// Options of `sweep` for all cells, and those of the search.
    pub options: StudyOptions,
    /// The axes, in the form of `--over`.
    pub over: Vec<String>,
    /// The reference cell: values by key. Axes without an entry define groups, each with its own reference.
    pub reference: BTreeMap<String, String>,
    /// Unit of the numbers along the axis below, if they have none.
    #[serde(default)]
    pub unit: String,
    /// The axis along which the area is compared; along an axis of names, every value is compared.
    pub along: String,
}

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
    pub fn settings(&self) -> Result<Option<Vec<(&'static Setting, String)>>, String> {
        let Self::Table(table) = self else { return Ok(None) };
        let all = || [CONDITIONS, SEARCH].into_iter().flatten();
        if let Some(name) = table.keys().find(|name| !all().any(|setting| setting.name == **name)) {
            let names: Vec<_> = all().map(|setting| setting.name).collect();
            return Err(format!("options: unknown option `{name}`; there are {}", names.join(", ")));
        }
        let mut found = Vec::new();
        for setting in all() {
            match table.get(setting.name) {
                None => {}
                Some(OptionValue::One(value)) => found.push((setting, value.to_string())),
                Some(OptionValue::Several(_)) if !setting.repeats => {
                    return Err(format!("options: `{}` can be given once only, not as a list", setting.name));
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

/// Why a study cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct StudyError(pub String);

/// Parses the study `name` from a TOML text.
///
/// # Errors
/// Names study, sweep and key.
pub fn parse(name: &str, text: &str) -> Result<Study, StudyError> {
    let wrong = |what: &str| StudyError(format!("study {name}: {}", what.trim()));
    let mut study: Study = toml::from_str(text).map_err(|e| wrong(&e.to_string()))?;
    study.name = name.into();
    for part in &study.parts {
        part.check().map_err(|e| wrong(&format!("sweep {}: {e}", part.name)))?;
    }
    Ok(study)
}

impl Part {
    /// Its axes.
    ///
    /// # Errors
    /// An invalid axis.
    pub fn axes(&self) -> Result<Vec<Axis>, String> {
        self.over.iter().map(|text| Axis::parse(text).map_err(|e| e.to_string())).collect()
    }

    fn check(&self) -> Result<(), String> {
        self.options.settings()?;
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '-';
        if self.name.is_empty() || !self.name.chars().all(plain) {
            return Err("a name is of letters, digits and hyphens".into());
        }
        let axes = self.axes()?;
        for (key, value) in &self.reference {
            let axis = axes.iter().find(|axis| axis.key == *key);
            if !axis.is_some_and(|axis| axis.values.contains(value)) {
                return Err(format!("reference: no axis has {key}={value}"));
            }
        }
        if !self.reference.contains_key(&self.along) {
            return Err(format!("along = `{}` is not in the reference", self.along));
        }
        if self.reference.len() > 3 {
            return Err("a reference of more than three axes can't be shown as a table".into());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert_eq!((text.typed(), text.settings()), ("--law h --speeds 4".into(), Ok(None)));
    }

    #[test]
    fn errors_in_a_file_are_named() {
        let right = "title='t'\nquestion='q'\n[[sweep]]\nname='a'\ntitle='t'\noptions=''\nover=['law=h,f']\n\
                     reference={law='h'}\nalong='law'\n";
        assert!(parse("s", right).is_ok());
        for (from, to, named) in [
            ("law='h'", "law='g'", "law=g"),
            ("along='law'", "along='imu'", "`imu`"),
            ("name='a'", "name='../a'", "name"),
            ("law=h,f", "law=h,h", "twice"),
            ("options=''", "option=''", "option"),
            ("options=''", "options={lwa='h'}", "`lwa`"),
            ("options=''", "options={law=['h','f']}", "`law` can be given once"),
            ("options=''", "options=3", "a table of options"),
        ] {
            let error = parse("s", &right.replace(from, to)).unwrap_err().0;
            assert!(error.starts_with("study s: ") && error.contains(named), "{error}");
        }
    }
}
