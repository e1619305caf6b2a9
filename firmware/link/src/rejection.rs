//! Rejections: the reason a request is not carried out, and its text.

use crate::bytes::{Reader, Writer};
use crate::key::Key;
use control::param::ParamError;
use core::fmt;

control::numbered! {
    /// Reason of a rejection.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum RejectReason {
        /// Torque can flow: parameters can't be changed, stored or reset.
        Engaged = 1,
        /// Unknown parameter.
        UnknownKey = 2,
        /// A value outside its range, or inconsistent with another parameter.
        OutOfRange = 3,
        /// A fractional value for an integer parameter.
        NotWhole = 4,
        /// Off, for a parameter that can't be off.
        NeverOff = 5,
        /// The parameter's group is off and must be switched on first.
        GroupOff = 6,
        /// Only a passed polarity check sets this parameter.
        OnlyByCheck = 7,
        /// Unknown request.
        UnknownRequest = 8,
        /// The request can't be decoded.
        Malformed = 9,
        /// Storing in flash failed; the previous record is still there.
        NotStored = 10,
        /// This image does not support the request.
        NotHere = 11,
    }
}

/// A rejection. Fields that do not apply are empty or 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rejection<'a> {
    /// Reason.
    pub reason: RejectReason,
    /// The parameter.
    pub key: Key<'a>,
    /// Rejected value.
    pub value: f32,
    /// Least allowed value.
    pub min: f32,
    /// Largest allowed value.
    pub max: f32,
}

impl<'a> Rejection<'a> {
    /// A rejection without a parameter.
    pub const fn of(reason: RejectReason) -> Self {
        Self::about(reason, Key::whole(""))
    }

    /// A rejection that concerns a parameter.
    pub const fn about(reason: RejectReason, key: Key<'a>) -> Self {
        Self { reason, key, value: 0.0, min: 0.0, max: 0.0 }
    }

    pub(crate) fn encode(&self, to: &mut Writer<'_>) {
        to.u8(self.reason as u8);
        [self.value, self.min, self.max].into_iter().for_each(|number| to.f32(number));
        to.text(self.key.parts());
    }

    pub(crate) fn decode(from: &mut Reader<'a>) -> Option<Self> {
        let reason = RejectReason::numbered(from.u8()?)?;
        let (value, min, max) = (from.f32()?, from.f32()?, from.f32()?);
        Some(Self { reason, key: Key::whole(from.text()?), value, min, max })
    }
}

impl From<ParamError> for Rejection<'static> {
    fn from(ParamError { leaf, value }: ParamError) -> Self {
        Self { reason: RejectReason::OutOfRange, key: Key::of(&leaf), value, min: leaf.min, max: leaf.max }
    }
}

impl fmt::Display for Rejection<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { reason, key, value, min, max } = self;
        match reason {
            RejectReason::Engaged => write!(f, "rejected while engaged"),
            RejectReason::UnknownKey => write!(f, "no parameter {key}"),
            // A limit that is off although another limit needs it (`Limits::cross`).
            RejectReason::OutOfRange if *value == f32::INFINITY => {
                write!(f, "{key} = none, but limits.rider_torque is on and needs it: {min} to {max}")
            }
            RejectReason::OutOfRange => write!(f, "{key} = {value} is outside {min} to {max}"),
            RejectReason::NotWhole => write!(f, "{key} = {value} is not a whole number of {min} to {max}"),
            RejectReason::NeverOff => write!(f, "{key} can't be off, only {min} to {max}"),
            RejectReason::GroupOff => write!(f, "{key} is in a group that is off; switch that on first"),
            RejectReason::OnlyByCheck => write!(f, "{key} is set by the polarity check alone"),
            RejectReason::UnknownRequest => write!(f, "no such request"),
            RejectReason::Malformed => write!(f, "the request can't be read"),
            RejectReason::NotStored => write!(f, "the flash did not keep it"),
            RejectReason::NotHere => write!(f, "this image can't do that"),
        }
    }
}
