//! A parameter as a board lists it, and its value in words: those of `--set`.

use control::law::LAW_NAMES;
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
    /// What its numbers mean.
    pub kind: Kind,
    /// Its value; `None` is a limit that is off.
    pub value: Option<f32>,
    /// What a reset makes it.
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
    /// The words a value may be.
    pub fn words(&self) -> Vec<&str> {
        match self.kind {
            Kind::Switch => vec!["off", "on"],
            Kind::Choice => self.names.iter().map(String::as_str).collect(),
            Kind::Limit => vec!["none"],
            Kind::Number | Kind::Count => Vec::new(),
        }
    }

    /// What it may be, in words: a range, names, or both.
    pub fn allowed(&self) -> String {
        let words = self.words().join(", ");
        match self.kind {
            Kind::Switch | Kind::Choice => words,
            Kind::Limit => format!("{} to {} or {words}", self.min, self.max),
            Kind::Number | Kind::Count => format!("{} to {}", self.min, self.max),
        }
    }

    /// A value in words; [`Parameter::parse`] reads it again, bit for bit.
    pub fn text(&self, value: Option<f32>) -> String {
        let Some(number) = value else { return "none".into() };
        let named = matches!(self.kind, Kind::Switch | Kind::Choice);
        let name = self.words().get(number as usize).filter(|_| named).map(|name| (*name).to_owned());
        name.unwrap_or_else(|| number.to_string())
    }

    /// Its value in TOML; in words again it is that of [`Parameter::text`].
    pub fn toml(&self) -> String {
        match (self.kind, self.value) {
            // With a point or an exponent: the largest are beyond TOML's whole numbers.
            (Kind::Number | Kind::Limit, Some(number)) => format!("{number:?}"),
            (Kind::Count, Some(number)) => number.to_string(),
            _ => format!("\"{}\"", self.text(self.value)),
        }
    }

    /// The value that words stand for, if it may be that.
    ///
    /// # Errors
    /// What is wrong, with key, value and what is allowed.
    pub fn parse(&self, text: &str) -> Result<Option<f32>, String> {
        let Self { key, min, max, .. } = self;
        let words = self.words();
        let place = words.iter().position(|word| *word == text);
        match (self.kind, place) {
            (Kind::Limit, Some(_)) => return Ok(None),
            (Kind::Switch | Kind::Choice, Some(place)) => return Ok(Some(place as f32)),
            (Kind::Switch | Kind::Choice, None) => {
                return Err(format!("{key} = `{text}` is none of {}", words.join(", ")));
            }
            (Kind::Number | Kind::Limit | Kind::Count, _) => {}
        }
        let allowed = self.allowed();
        let number: f32 =
            text.parse().map_err(|_| format!("{key} = `{text}` is no number; allowed: {allowed}"))?;
        if !(number >= *min && number <= *max) {
            return Err(format!("{key} = {text} is outside {allowed}"));
        }
        if self.kind == Kind::Count && number % 1.0 != 0.0 {
            return Err(format!("{key} = {text} is not a whole number of {allowed}"));
        }
        Ok(Some(number))
    }

    /// Whether it has this value, to the bit.
    pub fn has(&self, value: Option<f32>) -> bool {
        to_bits(self.value) == to_bits(value)
    }
}

/// A law in words, as of `--law`; a table's is `table`.
pub fn law_name(law: &Law) -> String {
    let name = LAW_NAMES.get(usize::from(law.number())).unwrap_or(&"?");
    match law {
        Law::Cl2 { .. } | Law::BalanceAssist { .. } => format!("{name}:{}", law.slope()),
        _ => (*name).to_owned(),
    }
}

/// The points of a table: speed \[m/s\] and gain \[N m s/rad\]; none for a formula.
pub fn law_points(law: &Law) -> Option<&[(f32, f32)]> {
    match law {
        Law::Table(table) => Some(GainSchedule::points(table)),
        _ => None,
    }
}

/// A law as the link's bytes.
pub fn law_bytes(law: &Law) -> Vec<u8> {
    let mut room = [0; LAW_BYTES];
    let mut writer = Writer::new(&mut room);
    encode(law, &mut writer);
    writer.finish().unwrap_or_default().to_vec()
}

/// A law of the link's bytes; `None` where they are none that this program knows.
pub fn law_of(bytes: &[u8]) -> Option<Law> {
    decode(&mut Reader(bytes)).ok()
}
