//! Databases of CAN messages (DBC): which signals are in which bits of which frame.
//!
//! `can-dbc` parses the text; this module converts the result to plain numbers. Files that are not UTF-8 are read as
//! Windows-1252, the encoding of most tools.
//!
//! **A raw value that means "no value" becomes NaN**: one that the database's value table names `SNA`, `NA`, `not
//! known`, `unknown`, `not available`, `not valid`, `invalid` or `no data`, with or without `signal`, `value` or `data`
//! before or after it, in any case and with any separator between the words. As a number it would be a plausible value
//! at the end of the signal's range. Signals of one bit keep both values: a flag named `invalid` is information. All
//! other names in value tables are ignored; the raw value remains a number.

use super::Remark;
use super::bits::{Order, Place, signed};
use super::frames::{Id, MOST_BYTES};
use can_dbc::{
    AttributeValue, ByteOrder, Dbc, MessageId, MultiplexIndicator, SignalExtendedValueType, ValueDescription,
    ValueType,
};
use std::collections::HashMap;

/// A database.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Database {
    /// Its messages.
    pub messages: Vec<Message>,
    places: HashMap<Id, usize>,
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

/// Reason for which a signal is unusable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
enum SignalFault {
    #[error("a floating-point number of {0} bits")]
    Float(u64),
    #[error("{0} bits, not 1 to 64")]
    Bits(u64),
    #[error("its bits are in no frame")]
    Place,
    #[error("its factor or offset is no finite number")]
    Factor,
    #[error("it has no multiplexor")]
    NoMultiplexor,
    #[error("it is its own multiplexor")]
    OwnMultiplexor,
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

    /// Whether a signal is in this frame, by its multiplexors. Their chain is not circular: [`Database::parse`] checks
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

    /// Parses a DBC file. Unusable parts of a message are recorded in the message.
    ///
    /// # Errors
    /// The text is no DBC (with the line), has no message, or an identifier has too many bits.
    pub fn parse(bytes: &[u8]) -> Result<Self, Remark> {
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => text.trim_start_matches('\u{feff}').to_owned(),
            Err(_) => can_dbc::decode_cp1252(bytes).unwrap_or_default().into_owned(),
        };
        wide_identifier(&text)?;
        let dbc = Dbc::try_from(text.as_str()).map_err(|error| not_read(&error.to_string()))?;
        let mut database = Self::default();
        // Tools store signals without a message here.
        for message in dbc.messages.iter().filter(|message| message.name != "VECTOR__INDEPENDENT_SIG_MSG") {
            let message = of(message, &dbc);
            if let Some(place) = database.places.get(&message.id) {
                let error = format!("message {} has the same identifier", message.name);
                database.messages[*place].unused.push(error);
                continue;
            }
            database.places.insert(message.id, database.messages.len());
            database.messages.push(message);
        }
        match database.messages.is_empty() {
            true => Err(Remark::of_file("no message (`BO_`) in it".to_owned())),
            false => Ok(database),
        }
    }
}

/// Rejects identifiers above 11 bits without the mark of 29 bits: `can-dbc` 10.0.0 uses their lower 16 bits.
fn wide_identifier(text: &str) -> Result<(), Remark> {
    const EXTENDED: u64 = 1 << 31;
    for (line, number) in text.lines().zip(1..) {
        let Some(rest) = line.trim_start().strip_prefix("BO_ ") else { continue };
        let id: Option<u64> = rest.split_whitespace().next().and_then(|word| word.parse().ok());
        if id.is_some_and(|id| id > 0x7ff && id & EXTENDED == 0) {
            let what = "its identifier is larger than 2047; those of 29 bits have 2147483648 added";
            return Err(Remark { line: Some(number), column: None, what: what.to_owned() });
        }
    }
    Ok(())
}

/// The parser's reason in one line. Its own text is a picture of the position: ` --> 3:5`, the line, and ` = expected
/// ...`.
fn not_read(error: &str) -> Remark {
    let place = error.trim_start().strip_prefix("--> ").and_then(|rest| rest.split(':').next());
    let line = place.and_then(|line| line.parse().ok());
    let expected = error.lines().find_map(|line| line.trim_start().strip_prefix("= "));
    let reason = expected.or(error.lines().next()).unwrap_or_default();
    Remark { line, column: None, what: format!("is no valid DBC: {reason}") }
}

fn id_of(id: MessageId) -> Id {
    match id {
        MessageId::Standard(number) => Id { number: u32::from(number), extended: false },
        MessageId::Extended(number) => Id { number, extended: true },
    }
}

/// A message, from all parts of a DBC that refer to it.
fn of(message: &can_dbc::Message, dbc: &Dbc) -> Message {
    let mut unused = Vec::new();
    let mut signals = Vec::new();
    for signal in &message.signals {
        match signal_of(signal, message.id, dbc) {
            Ok(usable) => signals.push((usable, &signal.multiplexer_indicator)),
            Err(error) => unused.push(format!("signal {}: {error}", signal.name)),
        }
    }
    let names: Vec<String> = signals.iter().map(|(signal, _)| signal.name.clone()).collect();
    let place = |name: &str| names.iter().position(|other| other == name);
    let switch = signals.iter().position(|(_, indicator)| **indicator == MultiplexIndicator::Multiplexor);
    let mut pages = Vec::new();
    for (signal, indicator) in &signals {
        let value = match indicator {
            MultiplexIndicator::MultiplexedSignal(value)
            | MultiplexIndicator::MultiplexorAndMultiplexedSignal(value) => *value,
            MultiplexIndicator::Multiplexor | MultiplexIndicator::Plain => {
                pages.push(Ok(None));
                continue;
            }
        };
        // `SG_MUL_VAL_` has precedence over the mark after the signal's name.
        let extended = dbc
            .extended_multiplex
            .iter()
            .find(|entry| entry.message_id == message.id && entry.signal_name == signal.name);
        let page = match extended {
            Some(entry) => place(&entry.multiplexor_signal_name).map(|switch| Page {
                switch,
                ranges: entry.mappings.iter().map(|range| (range.min_value, range.max_value)).collect(),
            }),
            None => switch.map(|switch| Page { switch, ranges: vec![(value, value)] }),
        };
        pages.push(page.map(Some).ok_or(SignalFault::NoMultiplexor));
    }
    let chain: Vec<Option<usize>> =
        pages.iter().map(|page| page.as_ref().ok()?.as_ref().map(|page| page.switch)).collect();
    let mut usable = Vec::new();
    for (place, ((mut signal, _), page)) in signals.into_iter().zip(pages).enumerate() {
        let error = match page {
            Ok(page) if !circular(place, &chain) => {
                signal.page = page;
                usable.push(signal);
                continue;
            }
            Ok(_) => SignalFault::OwnMultiplexor,
            Err(error) => error,
        };
        // The signal stays, as NaN, so that the indices of the others remain valid.
        unused.push(format!("signal {}: {error}", signal.name));
        usable.push(Signal { factor: f64::NAN, ..signal });
    }
    for signal in &mut usable {
        let long = dbc.signal_attribute(message.id, &signal.name, "SystemSignalLongSymbol");
        signal.name = long_name(long, &signal.name);
    }
    // Converted databases can have truncated names, two of which are then equal.
    for n in 1..usable.len() {
        if usable[..n].iter().any(|before| before.name == usable[n].name) {
            usable[n].name = format!("{} (bit {})", usable[n].name, usable[n].place.start);
        }
    }
    let name = long_name(dbc.message_attribute(message.id, "SystemMessageLongSymbol"), &message.name);
    Message { name, id: id_of(message.id), signals: usable, unused }
}

/// The full name of an object with more than 32 letters: Vector's tools truncate the name and store the full one in an
/// attribute.
fn long_name(attribute: Option<&AttributeValue>, name: &str) -> String {
    match attribute {
        Some(AttributeValue::String(long)) if !long.is_empty() => long.clone(),
        _ => name.to_owned(),
    }
}

/// Whether the chain of multiplexors from a signal is circular.
fn circular(from: usize, chain: &[Option<usize>]) -> bool {
    let mut at = from;
    for _ in 0..=chain.len() {
        match chain.get(at).copied().flatten() {
            Some(next) => at = next,
            None => return false,
        }
    }
    true
}

/// A signal without its multiplexing condition.
fn signal_of(signal: &can_dbc::Signal, message: MessageId, dbc: &Dbc) -> Result<Signal, SignalFault> {
    let float = dbc
        .signal_extended_value_type_list
        .iter()
        .find(|entry| entry.message_id == message && entry.signal_name == signal.name)
        .map(|entry| entry.signal_extended_value_type);
    let kind = match (float, &signal.value_type) {
        (Some(SignalExtendedValueType::IEEEfloat32Bit), _) if signal.size == 32 => Kind::F32,
        (Some(SignalExtendedValueType::IEEEdouble64bit), _) if signal.size == 64 => Kind::F64,
        (Some(SignalExtendedValueType::IEEEfloat32Bit | SignalExtendedValueType::IEEEdouble64bit), _) => {
            return Err(SignalFault::Float(signal.size));
        }
        (_, ValueType::Signed) => Kind::Signed,
        (_, ValueType::Unsigned) => Kind::Unsigned,
    };
    let order = match signal.byte_order {
        ByteOrder::LittleEndian => Order::Little,
        ByteOrder::BigEndian => Order::Big,
    };
    let bits = u8::try_from(signal.size).ok().filter(|bits| (1..=64).contains(bits));
    let bits = bits.ok_or(SignalFault::Bits(signal.size))?;
    let start = u16::try_from(signal.start_bit).ok().filter(|start| usize::from(*start) < 8 * MOST_BYTES);
    let place = start.map(|start| Place { start, bits, order }).filter(|place| place.bytes() <= MOST_BYTES);
    let place = place.ok_or(SignalFault::Place)?;
    if !(signal.factor.is_finite() && signal.offset.is_finite()) {
        return Err(SignalFault::Factor);
    }
    Ok(Signal {
        name: signal.name.clone(),
        unit: signal.unit.trim().to_owned(),
        place,
        kind,
        factor: signal.factor,
        offset: signal.offset,
        gaps: gaps(signal, message, dbc, kind, bits),
        page: None,
    })
}

/// Raw values of a signal whose name in the value table means "no value".
fn gaps(signal: &can_dbc::Signal, message: MessageId, dbc: &Dbc, kind: Kind, bits: u8) -> Vec<u64> {
    if bits == 1 || !matches!(kind, Kind::Unsigned | Kind::Signed) {
        return Vec::new();
    }
    let mask = u64::MAX >> (64 - u32::from(bits));
    let own = dbc.value_descriptions.iter().filter_map(|entry| match entry {
        ValueDescription::Signal { message_id, name, value_descriptions } => {
            (*message_id == message && *name == signal.name).then_some(value_descriptions)
        }
        ValueDescription::EnvironmentVariable { .. } => None,
    });
    // Tables of signed signals contain the number or its bits: -1 or 65535.
    let fits = |id: i64| id >= 0 && id as u64 <= mask || signed(id as u64 & mask, bits) == id;
    own.flatten()
        .filter(|entry| is_gap(&entry.description) && fits(entry.id))
        .map(|entry| entry.id as u64 & mask)
        .collect()
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
