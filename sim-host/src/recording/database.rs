//! A database of CAN messages: which signals are in which bits of which frame, and their values.
//!
//! **A raw value that means "no value" becomes NaN**: one that the database's value table names `SNA`, `NA`, `not
//! known`, `unknown`, `not available`, `not valid`, `invalid` or `no data`, with or without `signal`, `value` or `data`
//! before or after it, in any case and with any separator between the words. As a number it would be a plausible value
//! at the end of the signal's range. Signals of one bit keep both values: a flag named `invalid` is information. All
//! other names in value tables are ignored; the raw value remains a number.

use super::bits::{Place, signed};
use super::frames::Id;
use std::collections::HashMap;

/// A database.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Database {
    /// Its messages.
    pub messages: Vec<Message>,
    pub(super) places: HashMap<Id, usize>,
}

/// A message.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    /// Its name.
    pub name: String,
    /// The identifier of its frames.
    pub id: Id,
    /// Its signals.
    pub signals: Vec<Signal>,
    /// Parts of the message that cannot be used, with the reason.
    pub unused: Vec<String>,
}

/// A signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    /// Its name.
    pub name: String,
    /// Its unit, as in the database.
    pub unit: String,
    /// Its bits.
    pub place: Place,
    /// Number format of the bits.
    pub kind: Kind,
    /// Factor applied to the number.
    pub factor: f64,
    /// Offset added after the factor.
    pub offset: f64,
    /// Raw values that mean "no value".
    pub gaps: Vec<u64>,
    /// When it is in a frame; `None` means always.
    pub page: Option<Page>,
}

/// Number format of a signal's bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Unsigned integer.
    Unsigned,
    /// Integer in two's complement.
    Signed,
    /// An IEEE 754 number of 32 bits.
    F32,
    /// An IEEE 754 number of 64 bits.
    F64,
}

/// The condition of a multiplexed signal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Page {
    /// The multiplexor signal, by its index in the message.
    pub switch: usize,
    /// The signal is present if the multiplexor is and its raw value is in one of these ranges, both ends included.
    pub ranges: Vec<(u64, u64)>,
}

impl Signal {
    /// The value of raw bits in the signal's unit; NaN if they mean "no value".
    pub fn value(&self, raw: u64) -> f64 {
        if self.gaps.contains(&raw) {
            return f64::NAN;
        }
        let number = match self.kind {
            Kind::Unsigned => raw as f64,
            Kind::Signed => signed(raw, self.place.bits) as f64,
            Kind::F32 => f64::from(f32::from_bits(raw as u32)),
            Kind::F64 => f64::from_bits(raw),
        };
        number * self.factor + self.offset
    }
}

impl Message {
    /// The value of each signal in a frame; NaN for signals that the frame does not contain.
    pub fn values(&self, data: &[u8]) -> impl Iterator<Item = f64> {
        self.signals.iter().map(move |signal| {
            let raw = signal.place.of(data).filter(|_| self.is_there(signal, data));
            raw.map_or(f64::NAN, |raw| signal.value(raw))
        })
    }

    /// Bytes of a frame with all signals.
    pub fn bytes(&self) -> usize {
        self.signals.iter().map(|signal| signal.place.bytes()).max().unwrap_or(0)
    }

    /// Whether a signal is in this frame, by its multiplexors. Their chain is not circular: `Database::parse` checks
    /// it.
    fn is_there(&self, signal: &Signal, data: &[u8]) -> bool {
        let Some(page) = &signal.page else { return true };
        let switch = &self.signals[page.switch];
        let chosen = |raw: u64| page.ranges.iter().any(|(first, last)| (*first..=*last).contains(&raw));
        self.is_there(switch, data) && switch.place.of(data).is_some_and(chosen)
    }
}

impl Database {
    /// The message of an identifier.
    pub fn message(&self, id: Id) -> Option<(usize, &Message)> {
        let place = *self.places.get(&id)?;
        Some((place, self.messages.get(place)?))
    }
}

/// Whether a name in a value table means "no value".
pub fn is_gap(name: &str) -> bool {
    const NONE: [&str; 10] = [
        "sna",
        "na",
        "n a",
        "not known",
        "unknown",
        "not available",
        "notavailable",
        "not valid",
        "invalid",
        "no data",
    ];
    const OF: [&str; 3] = ["signal", "value", "data"];
    let lower = name.to_lowercase();
    let mut tokens: Vec<&str> =
        lower.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    if NONE.contains(&tokens.join(" ").as_str()) {
        return true;
    }
    if tokens.first().is_some_and(|first| OF.contains(first)) {
        tokens.remove(0);
    } else if tokens.last().is_some_and(|last| OF.contains(last)) {
        tokens.pop();
    }
    NONE.contains(&tokens.join(" ").as_str())
}
