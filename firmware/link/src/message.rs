//! What a frame can say.
//!
//! Fixed little-endian fields, as in `control::wire`, whose bytes of frames, commands and laws these are:
//! one table tells every byte, no type of `control` needs a serialiser, and the largest size of each is
//! known when compiling. Kinds below 0x80 go to the board, the others come from it. Bytes after those that
//! are known are passed over, so that a message may grow at its end without a new version.

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
    /// To the board: who are you? Answer: [`Message::Hello`].
    AskHello,
    /// To the board: list the parameters beginning with this one. Answer: [`Message::Page`].
    List {
        /// The place in the list of the first that is wanted.
        from: u16,
    },
    /// To the board: a parameter's value. Answer: [`Message::Value`].
    Get {
        /// Which.
        key: Key<'a>,
    },
    /// To the board: set a parameter. Answer: [`Message::Value`].
    Set {
        /// Which.
        key: Key<'a>,
        /// To what; `None` switches a limit off.
        value: Option<f32>,
    },
    /// To the board: the whole law. Answer: [`Message::Law`].
    GetLaw,
    /// To the board: set the whole law, its bytes as of [`crate::law`]. Answer: [`Message::Law`].
    SetLaw(&'a [u8]),
    /// To the board: keep the parameters in flash. Answer: [`Message::Done`].
    Store,
    /// To the board: all parameters to their defaults, not yet in flash. Answer: [`Message::Done`].
    Reset,
    /// To the board: a fault that was kept. Answer: [`Message::StoredFault`].
    ListFaults {
        /// Its place, the newest at 0.
        from: u16,
    },
    /// To the board: forget the faults. Answer: [`Message::Done`].
    ClearFaults,
    /// To the board, processor in the loop: begin anew, with the configuration whose bytes came before if they are
    /// all there, else with the one in force. Answer: [`Message::Done`].
    PilReset,
    /// To the board, processor in the loop: bytes of a configuration as of [`control::wire::encode_config`]. No answer.
    PilConfig {
        /// The place of the first of them.
        at: u16,
        /// The bytes.
        bytes: &'a [u8],
    },
    /// To the board, processor in the loop: a control step of these sensors. Answer: [`Message::PilCommand`].
    PilFrame(SensorFrame),
    /// From the board: who it is.
    Hello(Hello<'a>),
    /// From the board: a part of the list.
    Page(Page<'a>),
    /// From the board: a parameter's value, after it was set if it was.
    Value {
        /// Which.
        key: Key<'a>,
        /// Its value; `None` is a limit that is off.
        value: Option<f32>,
    },
    /// From the board: the law, its bytes as of [`crate::law`].
    Law(&'a [u8]),
    /// From the board: it is done.
    Done,
    /// From the board: it is not done, and why.
    Refused(Rejection<'a>),
    /// From the board: a frame of another version came in. Its frame tells the version spoken here.
    WrongVersion {
        /// The version that came in.
        theirs: u8,
    },
    /// From the board: a fault that was kept, and how many there are.
    StoredFault(StoredFault<'a>),
    /// From the board, processor in the loop: the command of a step. Its number is that of the newest sensor frame.
    PilCommand {
        /// The command.
        command: Command,
        /// The part of the torque that is permitted, 0 to 1.
        authority: f32,
    },
    /// From the board, unasked: a control step.
    Telemetry(Telemetry),
    /// From the board, unasked: a fault.
    Fault(FaultRecord<'a>),
    /// From the board, unasked: words, cut to what a frame holds.
    Log(&'a str),
}

/// Why a whole frame of the right version is no message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoMessage {
    /// There is no message of this kind.
    UnknownKind(u8),
    /// Too few bytes, or a field that means nothing.
    Malformed(u8),
}

impl<'a> Message<'a> {
    /// The number of its kind.
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
            Message::Refused(_) => 0x86,
            Message::WrongVersion { .. } => 0x87,
            Message::StoredFault(_) => 0x88,
            Message::PilCommand { .. } => 0x91,
            Message::Telemetry(_) => 0xa0,
            Message::Fault(_) => 0xa1,
            Message::Log(_) => 0xa2,
        }
    }

    /// Puts it on the line into `to` as a frame of this number; how many bytes it takes. `None`: no room, or
    /// a text is too long.
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
            Message::Refused(rejection) => rejection.encode(to),
            Message::WrongVersion { theirs } => to.u8(*theirs),
            Message::StoredFault(kept) => kept.encode(to),
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

    /// Reads the message of a frame.
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
            0x86 => Rejection::decode(&mut from).map(Message::Refused),
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
