//! The messages of the link, and their encoding.
//!
//! Fixed little-endian fields; frames, commands and laws are encoded as in `control::wire`. The largest size of each
//! message is a constant, and no type of `control` needs a serialiser. Kinds below 0x80 go to the board, the others
//! come from it. Bytes after the known ones are ignored, so that a message can grow at its end without a new version.

use crate::bytes::{Reader, Writer};
use crate::frame::{Frame, MAX_PAYLOAD, encode_with};
use crate::key::Key;
use crate::page::Page;
use crate::rejection::Rejection;
use crate::report::{FaultRecord, Hello, StoredFault, cut};
use crate::telemetry::{self, Telemetry};
use control::wire::{encode_command, encode_frame};
use control::{Command, SensorFrame};

/// A message, to or from the board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Message<'a> {
    /// To the board: request its identity. Answer: [`Message::Hello`].
    AskHello,
    /// To the board: list the parameters from an index. Answer: [`Message::Page`].
    List {
        /// Index of the first parameter.
        from: u16,
    },
    /// To the board: read a parameter. Answer: [`Message::Value`].
    Get {
        /// Key of the parameter.
        key: Key<'a>,
    },
    /// To the board: set a parameter. Answer: [`Message::Value`].
    Set {
        /// Key of the parameter.
        key: Key<'a>,
        /// New value; `None` switches a limit off.
        value: Option<f32>,
    },
    /// To the board: read the whole law. Answer: [`Message::Law`].
    GetLaw,
    /// To the board: set the whole law, encoded as in [`crate::law`]. Answer: [`Message::Law`].
    SetLaw(&'a [u8]),
    /// To the board: store the parameters in flash. Answer: [`Message::Done`].
    Store,
    /// To the board: reset all parameters to their defaults, without storing them. Answer: [`Message::Done`].
    Reset,
    /// To the board: read a stored fault. Answer: [`Message::StoredFault`].
    ListFaults {
        /// Index of the fault, 0 for the newest.
        from: u16,
    },
    /// To the board: delete the stored faults. Answer: [`Message::Done`].
    ClearFaults,
    /// To the board, processor in the loop: restart the controller with the configuration received before, if
    /// complete, else with the current one. Answer: [`Message::Done`].
    PilReset,
    /// To the board, processor in the loop: a part of an encoded [`control::wire::encode_config`]. No answer.
    PilConfig {
        /// Offset of the first byte.
        at: u16,
        /// The bytes.
        bytes: &'a [u8],
    },
    /// To the board, processor in the loop: run a control step with these sensors. Answer: [`Message::PilCommand`].
    PilFrame(SensorFrame),
    /// From the board: its identity.
    Hello(Hello<'a>),
    /// From the board: a part of the parameter list.
    Page(Page<'a>),
    /// From the board: a parameter's value, after a change if it was set.
    Value {
        /// Key of the parameter.
        key: Key<'a>,
        /// Value; `None` is a limit that is off.
        value: Option<f32>,
    },
    /// From the board: the law, encoded as in [`crate::law`].
    Law(&'a [u8]),
    /// From the board: the request is done.
    Done,
    /// From the board: the request is rejected, with the reason.
    Rejected(Rejection<'a>),
    /// From the board: a frame of another version was received. The answer's frame has the board's version.
    WrongVersion {
        /// Version of the received frame.
        theirs: u8,
    },
    /// From the board: a stored fault, and the number of stored faults.
    StoredFault(StoredFault<'a>),
    /// From the board, processor in the loop: the command of a step. Its sequence number is that of the newest sensor
    /// frame.
    PilCommand {
        /// The command.
        command: Command,
        /// Authority, 0 to 1.
        authority: f32,
    },
    /// From the board, unsolicited: a control step.
    Telemetry(Telemetry),
    /// From the board, unsolicited: a fault.
    Fault(FaultRecord<'a>),
    /// From the board, unsolicited: a log text, cut to a frame's payload.
    Log(&'a str),
}

/// Error of decoding a frame of the right version.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoMessage {
    /// Unknown kind.
    UnknownKind(u8),
    /// Too few bytes, or an invalid field.
    Malformed(u8),
}

impl<'a> Message<'a> {
    /// Number of the kind.
    pub const fn kind(&self) -> u8 {
        match self {
            Message::AskHello => 0x01,
            Message::List { .. } => 0x02,
            Message::Get { .. } => 0x03,
            Message::Set { .. } => 0x04,
            Message::GetLaw => 0x05,
            Message::SetLaw(_) => 0x06,
            Message::Store => 0x07,
            Message::Reset => 0x08,
            Message::ListFaults { .. } => 0x09,
            Message::ClearFaults => 0x0a,
            Message::PilReset => 0x10,
            Message::PilFrame(_) => 0x11,
            Message::PilConfig { .. } => 0x12,
            Message::Hello(_) => 0x81,
            Message::Page(_) => 0x82,
            Message::Value { .. } => 0x83,
            Message::Law(_) => 0x84,
            Message::Done => 0x85,
            Message::Rejected(_) => 0x86,
            Message::WrongVersion { .. } => 0x87,
            Message::StoredFault(_) => 0x88,
            Message::PilCommand { .. } => 0x91,
            Message::Telemetry(_) => 0xa0,
            Message::Fault(_) => 0xa1,
            Message::Log(_) => 0xa2,
        }
    }

    /// Encodes the message as a frame of this sequence number and returns its length \[bytes\]. `None` if it does not
    /// fit, or a text is too long.
    pub fn encode(&self, sequence: u16, to: &mut [u8]) -> Option<usize> {
        encode_with(self.kind(), sequence, |payload| self.fill(payload), to)
    }

    fn fill(&self, to: &mut Writer<'_>) {
        match self {
            Message::List { from } | Message::ListFaults { from } => to.u16(*from),
            Message::Get { key } => to.text(key.parts()),
            Message::Set { key, value } | Message::Value { key, value } => {
                to.scalar(*value);
                to.text(key.parts());
            }
            Message::SetLaw(law) | Message::Law(law) => to.put(law),
            Message::PilFrame(frame) => to.put(&encode_frame(frame)),
            Message::Hello(hello) => hello.encode(to),
            Message::Page(page) => {
                to.u16(page.from);
                to.u16(page.total);
                to.u8(page.count);
                to.put(page.bytes);
            }
            Message::Rejected(rejection) => rejection.encode(to),
            Message::WrongVersion { theirs } => to.u8(*theirs),
            Message::StoredFault(stored) => stored.encode(to),
            Message::PilConfig { at, bytes } => {
                to.u16(*at);
                to.put(bytes);
            }
            Message::PilCommand { command, authority } => {
                to.put(&encode_command(command));
                to.f32(*authority);
            }
            Message::Telemetry(telemetry) => telemetry.encode(to),
            Message::Fault(fault) => fault.encode(to),
            Message::Log(text) => to.put(cut(text, MAX_PAYLOAD).as_bytes()),
            Message::AskHello
            | Message::GetLaw
            | Message::Store
            | Message::Reset
            | Message::ClearFaults
            | Message::PilReset
            | Message::Done => {}
        }
    }

    /// Decodes the message of a frame.
    ///
    /// # Errors
    /// As of [`NoMessage`].
    pub fn decode(frame: &Frame<'a>) -> Result<Self, NoMessage> {
        let mut from = Reader(frame.payload);
        let known = match frame.kind {
            0x01 => Some(Message::AskHello),
            0x02 => from.u16().map(|from| Message::List { from }),
            0x03 => from.text().map(|key| Message::Get { key: Key::whole(key) }),
            0x04 => valued(&mut from).map(|(key, value)| Message::Set { key, value }),
            0x05 => Some(Message::GetLaw),
            0x06 => Some(Message::SetLaw(frame.payload)),
            0x07 => Some(Message::Store),
            0x08 => Some(Message::Reset),
            0x09 => from.u16().map(|from| Message::ListFaults { from }),
            0x0a => Some(Message::ClearFaults),
            0x10 => Some(Message::PilReset),
            0x11 => telemetry::frame(&mut from).map(Message::PilFrame),
            0x12 => from.u16().map(|at| Message::PilConfig { at, bytes: from.0 }),
            0x81 => Hello::decode(&mut from).map(Message::Hello),
            0x82 => page(&mut from).map(Message::Page),
            0x83 => valued(&mut from).map(|(key, value)| Message::Value { key, value }),
            0x84 => Some(Message::Law(frame.payload)),
            0x85 => Some(Message::Done),
            0x86 => Rejection::decode(&mut from).map(Message::Rejected),
            0x87 => from.u8().map(|theirs| Message::WrongVersion { theirs }),
            0x88 => StoredFault::decode(&mut from).map(Message::StoredFault),
            0x91 => pil_command(&mut from),
            0xa0 => Telemetry::decode(&mut from).map(Message::Telemetry),
            0xa1 => FaultRecord::decode(&mut from).map(Message::Fault),
            0xa2 => core::str::from_utf8(frame.payload).ok().map(Message::Log),
            kind => return Err(NoMessage::UnknownKind(kind)),
        };
        known.ok_or(NoMessage::Malformed(frame.kind))
    }
}

fn valued<'a>(from: &mut Reader<'a>) -> Option<(Key<'a>, Option<f32>)> {
    let value = from.scalar()?;
    Some((Key::whole(from.text()?), value))
}

fn pil_command<'a>(from: &mut Reader<'a>) -> Option<Message<'a>> {
    Some(Message::PilCommand { command: telemetry::command(from)?, authority: from.f32()? })
}

fn page<'a>(from: &mut Reader<'a>) -> Option<Page<'a>> {
    Some(Page { from: from.u16()?, total: from.u16()?, count: from.u8()?, bytes: from.0 })
}
