//! What is asked of the parameters, and what is answered.
//!
//! A change is accepted as a whole or not at all: it is made on a copy, the copy is checked by
//! `Config::plan`, and only then it is the configuration.

use crate::bytes::{Reader, Writer};
use crate::frame::Received;
use crate::key::Key;
use crate::law::{self, LAW_BYTES, NoLaw};
use crate::message::{Message, NoMessage};
use crate::page::{self, PAGE_BYTES};
use crate::parameter_list::{Kind, ParameterView, each, get};
use crate::rejection::{RejectReason, Rejection};
use control::Config;

const CHECKED: Key<'static> = Key { group: CALIBRATION, name: "polarity_checked" };
/// The group whose change needs a new polarity check.
pub(crate) const CALIBRATION: &str = "calibration";

/// Sets a parameter; on any refusal the configuration stays as it was.
///
/// What changes the calibration takes back that a polarity check was passed.
///
/// # Errors
/// Why not.
pub fn set<'a>(config: &mut Config, key: Key<'a>, value: Option<f32>) -> Result<(), Rejection<'a>> {
    let mut draft = config.clone();
    let mut found = None;
    each(&mut draft, |view| {
        if view.key() != key {
            return view.value;
        }
        let checked = check(view, value);
        found = Some(checked);
        if checked.is_ok() { value } else { view.value }
    });
    found.unwrap_or(Err(Rejection::about(RejectReason::UnknownKey, key)))?;
    if key == CHECKED && value == Some(1.0) && !config.calibration.polarity_checked {
        return Err(Rejection::about(RejectReason::OnlyByCheck, CHECKED));
    }
    if draft.calibration != config.calibration {
        draft.calibration.polarity_checked = false;
    }
    if get(&draft, key).map(|view| view.value) != Some(value) {
        return Err(Rejection::about(RejectReason::GroupOff, key));
    }
    *config = draft.plan()?.config().clone();
    Ok(())
}

/// Whether a parameter may have a value, as far as it alone can say.
///
/// # Errors
/// Why not.
pub fn check(view: &ParameterView, value: Option<f32>) -> Result<(), Rejection<'static>> {
    let range = view.leaf.error(value.unwrap_or_default()).into();
    match value {
        None if view.kind == Kind::Limit => Ok(()),
        None => Err(Rejection { why: RejectReason::NeverOff, ..range }),
        Some(value) if view.leaf.check(value).is_err() => Err(range),
        Some(value) if matches!(view.kind, Kind::Number | Kind::Limit) || value % 1.0 == 0.0 => Ok(()),
        Some(_) => Err(Rejection { why: RejectReason::NotWhole, ..range }),
    }
}

/// Sets the whole law from its bytes; on any refusal it stays as it was.
///
/// # Errors
/// Why not.
pub fn set_law(config: &mut Config, bytes: &[u8]) -> Result<(), Rejection<'static>> {
    let law = law::decode(&mut Reader(bytes)).map_err(|no| match no {
        NoLaw::Malformed => Rejection::of(RejectReason::Malformed),
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
            NoRequest::Unknown(sequence) => {
                (sequence, Message::Refused(Rejection::of(RejectReason::UnknownRequest)))
            }
            NoRequest::Malformed(sequence) => {
                (sequence, Message::Refused(Rejection::of(RejectReason::Malformed)))
            }
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
/// `None`: the caller answers, for it has the flash, the image's name, the faults or the loop: `AskHello`, `Store`
/// when not engaged, `ListFaults`, `ClearFaults`, `PilReset`, `PilFrame`. What comes from a board is no request, and gets `None` as well.
pub fn answer<'a>(
    defaults: &Config,
    config: &mut Config,
    engaged: bool,
    request: &Message<'a>,
    room: &'a mut [u8; PAGE_BYTES],
) -> Option<Message<'a>> {
    use Message::{Done, Get, GetLaw, List, Reset, Set, SetLaw, Store};
    if engaged && matches!(request, Set { .. } | SetLaw(_) | Store | Reset) {
        return Some(Message::Refused(Rejection::of(RejectReason::Engaged)));
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

fn value<'a>(config: &Config, key: Key<'a>) -> Result<Message<'a>, Rejection<'a>> {
    let view = get(config, key).ok_or(Rejection::about(RejectReason::UnknownKey, key))?;
    Ok(Message::Value { key, value: view.value })
}

fn law_of<'a>(config: &Config, room: &'a mut [u8; PAGE_BYTES]) -> Message<'a> {
    const { assert!(LAW_BYTES <= PAGE_BYTES) };
    let mut writer = Writer::new(room);
    law::encode(&config.law, &mut writer);
    Message::Law(writer.finish().unwrap_or_default())
}
