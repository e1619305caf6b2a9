//! What is asked of the parameters, and what is answered.
//!
//! A change is accepted as a whole or not at all: it is made on a copy, the copy is checked by
//! `Config::plan`, and only then it is the configuration.

use crate::bytes::{Reader, Writer};
use crate::frame::Received;
use crate::key::Key;
use crate::law::{self, LAW_BYTES, NoLaw};
use crate::leaves::{Kind, Seen, each, get};
use crate::message::{Message, NoMessage};
use crate::page::{self, PAGE_BYTES};
use control::Config;
use control::param::ParamError;
use core::fmt;

const CHECKED: Key<'static> = Key { group: CALIBRATION, name: "polarity_checked" };
/// The group whose change needs a new polarity check.
pub(crate) const CALIBRATION: &str = "calibration";

/// Why something is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Why {
    /// Torque may flow: nothing may be changed, stored or reset.
    Engaged = 1,
    /// There is no such parameter.
    UnknownKey = 2,
    /// A value outside its range, perhaps of another parameter that this one must fit.
    OutOfRange = 3,
    /// A number with a fraction where only whole ones are.
    NotWhole = 4,
    /// Off, for a parameter that can't be.
    NeverOff = 5,
    /// The parameter's group is off; switch that on first.
    GroupOff = 6,
    /// Only a passed polarity check says that it was passed.
    OnlyByCheck = 7,
    /// There is no such request.
    UnknownRequest = 8,
    /// The request can't be read.
    Malformed = 9,
    /// The flash did not keep it; what it kept before is still there.
    NotStored = 10,
    /// This image can't do that.
    NotHere = 11,
}

impl Why {
    /// The reason of a number on the wire.
    pub fn numbered(number: u8) -> Option<Self> {
        use Why::*;
        let all = [
            Engaged,
            UnknownKey,
            OutOfRange,
            NotWhole,
            NeverOff,
            GroupOff,
            OnlyByCheck,
            UnknownRequest,
            Malformed,
            NotStored,
            NotHere,
        ];
        all.into_iter().find(|why| *why as u8 == number)
    }
}

/// A refusal. What it is not about is empty or 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refusal<'a> {
    /// Why.
    pub why: Why,
    /// The parameter.
    pub key: Key<'a>,
    /// The value that is refused.
    pub value: f32,
    /// Least allowed value.
    pub min: f32,
    /// Largest allowed value.
    pub max: f32,
}

impl<'a> Refusal<'a> {
    /// For a reason that needs no parameter.
    pub const fn of(why: Why) -> Self {
        Self::about(why, Key::whole(""))
    }

    const fn about(why: Why, key: Key<'a>) -> Self {
        Self { why, key, value: 0.0, min: 0.0, max: 0.0 }
    }

    pub(crate) fn encode(&self, to: &mut Writer<'_>) {
        to.u8(self.why as u8);
        [self.value, self.min, self.max].into_iter().for_each(|number| to.f32(number));
        to.text(self.key.parts());
    }

    pub(crate) fn decode(from: &mut Reader<'a>) -> Option<Self> {
        let why = Why::numbered(from.u8()?)?;
        let (value, min, max) = (from.f32()?, from.f32()?, from.f32()?);
        Some(Self { why, key: Key::whole(from.text()?), value, min, max })
    }
}

impl From<ParamError> for Refusal<'static> {
    fn from(ParamError { leaf, value }: ParamError) -> Self {
        Self { why: Why::OutOfRange, key: Key::of(&leaf), value, min: leaf.min, max: leaf.max }
    }
}

impl fmt::Display for Refusal<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { why, key, value, min, max } = self;
        match why {
            Why::Engaged => write!(f, "refused while engaged"),
            Why::UnknownKey => write!(f, "no parameter {key}"),
            Why::OutOfRange => write!(f, "{key} = {value} is outside {min} to {max}"),
            Why::NotWhole => write!(f, "{key} = {value} is not a whole number of {min} to {max}"),
            Why::NeverOff => write!(f, "{key} can't be off, only {min} to {max}"),
            Why::GroupOff => write!(f, "{key} is in a group that is off; switch that on first"),
            Why::OnlyByCheck => write!(f, "{key} is set by the polarity check alone"),
            Why::UnknownRequest => write!(f, "no such request"),
            Why::Malformed => write!(f, "the request can't be read"),
            Why::NotStored => write!(f, "the flash did not keep it"),
            Why::NotHere => write!(f, "this image can't do that"),
        }
    }
}

/// Sets a parameter; on any refusal the configuration stays as it was.
///
/// What changes the calibration takes back that a polarity check was passed.
///
/// # Errors
/// Why not.
pub fn set<'a>(config: &mut Config, key: Key<'a>, value: Option<f32>) -> Result<(), Refusal<'a>> {
    let mut draft = config.clone();
    let mut found = None;
    each(&mut draft, |seen| {
        if seen.key() != key {
            return seen.value;
        }
        let checked = check(seen, value);
        found = Some(checked);
        if checked.is_ok() { value } else { seen.value }
    });
    found.unwrap_or(Err(Refusal::about(Why::UnknownKey, key)))?;
    if key == CHECKED && value == Some(1.0) && !config.calibration.polarity_checked {
        return Err(Refusal::about(Why::OnlyByCheck, CHECKED));
    }
    if draft.calibration != config.calibration {
        draft.calibration.polarity_checked = false;
    }
    if get(&draft, key).map(|seen| seen.value) != Some(value) {
        return Err(Refusal::about(Why::GroupOff, key));
    }
    *config = draft.plan()?.config().clone();
    Ok(())
}

/// Whether a parameter may have a value, as far as it alone can say.
///
/// # Errors
/// Why not.
pub fn check(seen: &Seen, value: Option<f32>) -> Result<(), Refusal<'static>> {
    let range = seen.leaf.error(value.unwrap_or_default()).into();
    match value {
        None if seen.kind == Kind::Limit => Ok(()),
        None => Err(Refusal { why: Why::NeverOff, ..range }),
        Some(value) if seen.leaf.check(value).is_err() => Err(range),
        Some(value) if matches!(seen.kind, Kind::Number | Kind::Limit) || value % 1.0 == 0.0 => Ok(()),
        Some(_) => Err(Refusal { why: Why::NotWhole, ..range }),
    }
}

/// Sets the whole law from its bytes; on any refusal it stays as it was.
///
/// # Errors
/// Why not.
pub fn set_law(config: &mut Config, bytes: &[u8]) -> Result<(), Refusal<'static>> {
    let law = law::decode(&mut Reader(bytes)).map_err(|no| match no {
        NoLaw::Malformed => Refusal::of(Why::Malformed),
        NoLaw::Refused(error) => error.into(),
    })?;
    *config = Config { law, ..config.clone() }.plan()?.config().clone();
    Ok(())
}

/// Why what was received is no request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoRequest {
    /// It is of this version.
    WrongVersion(u8),
    /// The frame of this number is of no kind there is.
    Unknown(u16),
    /// The frame of this number can't be read.
    Malformed(u16),
}

impl NoRequest {
    /// What to answer, and under which number; 0 where that of the request is not known.
    pub fn answer(self) -> (u16, Message<'static>) {
        match self {
            NoRequest::WrongVersion(theirs) => (0, Message::WrongVersion { theirs }),
            NoRequest::Unknown(sequence) => (sequence, Message::Refused(Refusal::of(Why::UnknownRequest))),
            NoRequest::Malformed(sequence) => (sequence, Message::Refused(Refusal::of(Why::Malformed))),
        }
    }
}

/// What was received as a request and its number.
///
/// # Errors
/// As of [`NoRequest`], which has the answer to it.
pub fn request<'a>(received: &Received<'a>) -> Result<(u16, Message<'a>), NoRequest> {
    match received {
        Received::WrongVersion { theirs } => Err(NoRequest::WrongVersion(*theirs)),
        Received::Frame(frame) => match Message::decode(frame) {
            Ok(message) => Ok((frame.sequence, message)),
            Err(NoMessage::UnknownKind(_)) => Err(NoRequest::Unknown(frame.sequence)),
            Err(NoMessage::Malformed(_)) => Err(NoRequest::Malformed(frame.sequence)),
        },
    }
}

/// Carries out what is asked of the parameters and answers it; the answer is put together in `room`.
///
/// `None`: the caller answers, for it has the flash, the image's name or the loop: `AskHello`, `Store` when not
/// engaged, `PilReset`, `PilFrame`. What comes from a board is no request, and gets `None` as well.
pub fn answer<'a>(
    defaults: &Config,
    config: &mut Config,
    engaged: bool,
    request: &Message<'a>,
    room: &'a mut [u8; PAGE_BYTES],
) -> Option<Message<'a>> {
    use Message::{Done, Get, GetLaw, List, Reset, Set, SetLaw, Store};
    if engaged && matches!(request, Set { .. } | SetLaw(_) | Store | Reset) {
        return Some(Message::Refused(Refusal::of(Why::Engaged)));
    }
    let answer = match *request {
        List { from } => Ok(Message::Page(page::fill(defaults, config, from, room))),
        Get { key } => value(config, key),
        Set { key, value: wanted } => set(config, key, wanted).and_then(|()| value(config, key)),
        GetLaw => Ok(law_of(config, room)),
        SetLaw(bytes) => set_law(config, bytes).map(|()| law_of(config, room)),
        Reset => {
            *config = defaults.clone();
            config.calibration.polarity_checked = false;
            Ok(Done)
        }
        _ => return None,
    };
    Some(answer.unwrap_or_else(Message::Refused))
}

fn value<'a>(config: &Config, key: Key<'a>) -> Result<Message<'a>, Refusal<'a>> {
    let seen = get(config, key).ok_or(Refusal::about(Why::UnknownKey, key))?;
    Ok(Message::Value { key, value: seen.value })
}

fn law_of<'a>(config: &Config, room: &'a mut [u8; PAGE_BYTES]) -> Message<'a> {
    const { assert!(LAW_BYTES <= PAGE_BYTES) };
    let mut writer = Writer::new(room);
    law::encode(&config.law, &mut writer);
    Message::Law(writer.finish().unwrap_or_default())
}
