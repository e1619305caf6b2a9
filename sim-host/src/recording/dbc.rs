//! Reads databases of CAN messages from text (DBC).
//!
//! `can-dbc` parses the text; this module converts the result to plain numbers. Files that are not UTF-8 are read as
//! Windows-1252, the encoding of most tools.

use super::Remark;
use super::bits::{Order, Place, signed};
use super::database::{Database, Kind, Message, Page, Signal, is_gap};
use super::frames::{Id, MOST_BYTES};
use can_dbc::{
    AttributeValue, ByteOrder, Dbc, MessageId, MultiplexIndicator, SignalExtendedValueType, ValueDescription,
    ValueType,
};

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

impl Database {
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
