//! Requests about parameters: checks them, carries them out and answers them.
//!
//! A change is accepted as a whole or not at all: it is applied to a copy, `Config::plan` checks the copy, and only
//! then the copy replaces the configuration.

use crate::bytes::{Reader, Writer};
use crate::frame::Received;
use crate::key::Key;
use crate::law::{self, LAW_BYTES, NoLaw};
use crate::message::{Message, NoMessage};
use crate::page::{self, PAGE_BYTES};
use crate::parameter_list::{Kind, ParameterView, each, get};
use crate::rejection::{RejectReason, Rejection};
use control::Config;
use control::param::{ParamError, ParamSpec};

const CHECKED: Key<'static> = Key { group: CALIBRATION, name: "polarity_checked" };
/// The group whose change needs a new polarity check.
pub(crate) const CALIBRATION: &str = "calibration";

/// Sets a parameter; on a rejection the configuration stays unchanged.
///
/// A change of the calibration clears `polarity_checked`.
///
/// # Errors
/// The reason of the rejection.
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

/// Checks the rate of the control step against that of the board, which no parameter can change.
///
/// # Errors
/// States the board's rate as the only value.
pub fn check_rate(config: &Config, board_hz: f32) -> Result<(), ParamError> {
    ParamSpec::new("", "rate_hz", board_hz, board_hz).check(config.rate_hz)
}

/// Checks a parameter's value by itself: kind and range.
///
/// # Errors
/// The reason of the rejection.
pub fn check(view: &ParameterView, value: Option<f32>) -> Result<(), Rejection<'static>> {
    let range = view.leaf.error(value.unwrap_or_default()).into();
    match value {
        None if view.kind == Kind::Limit => Ok(()),
        None => Err(Rejection { reason: RejectReason::NeverOff, ..range }),
        Some(value) if view.leaf.check(value).is_err() => Err(range),
        Some(value) if matches!(view.kind, Kind::Number | Kind::Limit) || value % 1.0 == 0.0 => Ok(()),
        Some(_) => Err(Rejection { reason: RejectReason::NotWhole, ..range }),
    }
}

/// Sets the whole law from its encoding; on a rejection the law stays unchanged.
///
/// # Errors
/// The reason of the rejection.
pub fn set_law(config: &mut Config, bytes: &[u8]) -> Result<(), Rejection<'static>> {
    let law = law::decode(&mut Reader(bytes)).map_err(|no| match no {
        NoLaw::Malformed => Rejection::of(RejectReason::Malformed),
        NoLaw::Rejected(error) => error.into(),
    })?;
    *config = Config { law, ..config.clone() }.plan()?.config().clone();
    Ok(())
}

/// Error of decoding a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoRequest {
    /// A frame of this other version.
    WrongVersion(u8),
    /// Unknown kind; the frame has this sequence number.
    Unknown(u16),
    /// Undecodable payload; the frame has this sequence number.
    Malformed(u16),
}

impl NoRequest {
    /// The answer and its sequence number; 0 if the request's number is unknown.
    pub fn answer(self) -> (u16, Message<'static>) {
        match self {
            NoRequest::WrongVersion(theirs) => (0, Message::WrongVersion { theirs }),
            NoRequest::Unknown(sequence) => {
                (sequence, Message::Rejected(Rejection::of(RejectReason::UnknownRequest)))
            }
            NoRequest::Malformed(sequence) => {
                (sequence, Message::Rejected(Rejection::of(RejectReason::Malformed)))
            }
        }
    }
}

/// Decodes a received frame as a request with its sequence number.
///
/// # Errors
/// As of [`NoRequest`], which has the answer.
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

/// Carries out a request about parameters and returns the answer, built in `room`. The rate of the control step stays that of
/// the board's `defaults`.
///
/// `None` if the caller has to handle the request, since it has the flash, the image's name, the faults or the loop:
/// `AskHello`, `Store` when not engaged, `ListFaults`, `ClearFaults`, `PilReset`, `PilConfig`, `PilFrame`. Messages
/// from a board give `None` too.
pub fn answer<'a>(
    defaults: &Config,
    config: &mut Config,
    engaged: bool,
    request: &Message<'a>,
    room: &'a mut [u8; PAGE_BYTES],
) -> Option<Message<'a>> {
    use Message::{Done, Get, GetLaw, List, Reset, Set, SetLaw, Store};
    if engaged && matches!(request, Set { .. } | SetLaw(_) | Store | Reset) {
        return Some(Message::Rejected(Rejection::of(RejectReason::Engaged)));
    }
    let answer = match *request {
        List { from } => Ok(Message::Page(page::fill(defaults, config, from, room))),
        Get { key } => value(config, key),
        Set { key, value: wanted } => {
            let mut draft = config.clone();
            let checked = set(&mut draft, key, wanted);
            let checked = checked.and_then(|()| Ok(check_rate(&draft, defaults.rate_hz)?));
            checked.and_then(|()| {
                *config = draft;
                value(config, key)
            })
        }
        GetLaw => Ok(law_of(config, room)),
        SetLaw(bytes) => set_law(config, bytes).map(|()| law_of(config, room)),
        Reset => {
            *config = defaults.clone();
            config.calibration.polarity_checked = false;
            Ok(Done)
        }
        _ => return None,
    };
    Some(answer.unwrap_or_else(Message::Rejected))
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
