//! A parameter as a board lists it, and its value as text in the form of `--set`.

use control::{GainSchedule, Law};
use link::bytes::{Reader, Writer, to_bits};
use link::law::{LAW_BYTES, decode, encode};
use link::page::Entry;
use link::parameter_list::Kind;

/// A parameter as a board lists it.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub key: String,
    /// The kind of its value.
    pub kind: Kind,
    /// Its value; `None` is a disabled limit.
    pub value: Option<f32>,
    /// Its value after a reset.
    pub default: Option<f32>,
    /// Least allowed value.
    pub min: f32,
    /// Largest allowed value.
    pub max: f32,
    /// Its unit; empty for a plain number.
    pub unit: &'static str,
    /// The names of a choice, in the order of their numbers; empty for all others.
    pub names: Vec<String>,
}

impl From<Entry<'_>> for Parameter {
    fn from(entry: Entry<'_>) -> Self {
        Self {
            key: entry.key.to_string(),
            kind: entry.kind,
            value: entry.value,
            default: entry.default,
            min: entry.min,
            max: entry.max,
            unit: entry.unit(),
            names: entry.names.split_whitespace().map(String::from).collect(),
        }
    }
}

impl Parameter {
    /// The names that the value can have.
    pub fn words(&self) -> Vec<&str> {
        match self.kind {
            Kind::Switch => vec!["off", "on"],
            Kind::Choice => self.names.iter().map(String::as_str).collect(),
            Kind::Limit => vec!["none"],
            Kind::Number | Kind::Count => Vec::new(),
        }
    }

    /// The allowed values as text: a range, names, or both.
    pub fn allowed(&self) -> String {
        let words = self.words().join(", ");
        match self.kind {
            Kind::Switch | Kind::Choice => words,
            Kind::Limit => format!("{} to {} or {words}", self.min, self.max),
            Kind::Number | Kind::Count => format!("{} to {}", self.min, self.max),
        }
    }

    /// A value as text; [`Parameter::parse`] returns it bit for bit.
    pub fn text(&self, value: Option<f32>) -> String {
        let Some(number) = value else { return "none".into() };
        let named = matches!(self.kind, Kind::Switch | Kind::Choice);
        let name = self.words().get(number as usize).filter(|_| named).map(|name| (*name).to_owned());
        name.unwrap_or_else(|| number.to_string())
    }

    /// Its value in TOML; converted to text, it equals that of [`Parameter::text`].
    pub fn toml(&self) -> String {
        match (self.kind, self.value) {
            // With a point or an exponent, since the largest values exceed TOML's integers.
            (Kind::Number | Kind::Limit, Some(number)) => format!("{number:?}"),
            (Kind::Count, Some(number)) => number.to_string(),
            _ => format!("\"{}\"", self.text(self.value)),
        }
    }

    /// The value of a text, if it is allowed.
    ///
    /// # Errors
    /// The error with key, value and the allowed values.
    pub fn parse(&self, text: &str) -> Result<Option<f32>, ValueError> {
        let Self { key, min, max, .. } = self;
        let (of, given) = (|| key.clone(), || text.to_owned());
        let words = self.words();
        let place = words.iter().position(|word| *word == text);
        match (self.kind, place) {
            (Kind::Limit, Some(_)) => return Ok(None),
            (Kind::Switch | Kind::Choice, Some(place)) => return Ok(Some(place as f32)),
            (Kind::Switch | Kind::Choice, None) => {
                return Err(ValueError::Choice { key: of(), value: given(), known: words.join(", ") });
            }
            (Kind::Number | Kind::Limit | Kind::Count, _) => {}
        }
        let allowed = self.allowed();
        let Ok(number) = text.parse::<f32>() else {
            return Err(ValueError::Number { key: of(), value: given(), allowed });
        };
        if !(number >= *min && number <= *max) {
            return Err(ValueError::Range { key: of(), value: given(), allowed });
        }
        if self.kind == Kind::Count && number % 1.0 != 0.0 {
            return Err(ValueError::Whole { key: of(), value: given(), allowed });
        }
        Ok(Some(number))
    }

    /// Whether it has this value, bit for bit.
    pub fn has(&self, value: Option<f32>) -> bool {
        to_bits(self.value) == to_bits(value)
    }
}

/// A value that a board's parameter cannot have.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ValueError {
    /// No parameter of the board.
    #[error("the board has no parameter {0}")]
    NoParameter(String),
    /// None of the names that it can have.
    #[error("{key} = `{value}`: expected one of {known}")]
    Choice {
        /// The parameter.
        key: String,
        /// As given.
        value: String,
        /// The names.
        known: String,
    },
    /// Not a number.
    #[error("{key} = `{value}` is no number; allowed: {allowed}")]
    Number {
        /// The parameter.
        key: String,
        /// As given.
        value: String,
        /// The range.
        allowed: String,
    },
    /// A number outside its range.
    #[error("{key} = {value} is outside {allowed}")]
    Range {
        /// The parameter.
        key: String,
        /// As given.
        value: String,
        /// The range.
        allowed: String,
    },
    /// A number that must be whole.
    #[error("{key} = {value} is not a whole number of {allowed}")]
    Whole {
        /// The parameter.
        key: String,
        /// As given.
        value: String,
        /// The range.
        allowed: String,
    },
}

/// The points of a table: speed \[m/s\] and gain \[N m s/rad\]; none for a formula.
pub fn law_points(law: &Law) -> Option<&[(f32, f32)]> {
    match law {
        Law::Table(table) => Some(GainSchedule::points(table)),
        _ => None,
    }
}

/// A law, encoded in the link's bytes.
pub fn law_bytes(law: &Law) -> Vec<u8> {
    let mut room = [0; LAW_BYTES];
    let mut writer = Writer::new(&mut room);
    encode(law, &mut writer);
    writer.finish().unwrap_or_default().to_vec()
}

/// A law, decoded from the link's bytes; `None` if this program does not know it.
pub fn law_of(bytes: &[u8]) -> Option<Law> {
    decode(&mut Reader(bytes)).ok()
}
