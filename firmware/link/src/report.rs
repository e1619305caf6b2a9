//! Who the board is, and what went wrong with it.

use crate::bytes::{Reader, Writer};
use crate::frame::CRC;
use crate::telemetry;
use control::wire::encode_config;
use control::{Causes, Config, Mode};

/// Who the board is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hello<'a> {
    /// The image's name.
    pub image: &'a str,
    /// The program's version.
    pub version: &'a str,
    /// The commit it is made from.
    pub commit: &'a str,
    /// [`config_hash`] of the configuration in force.
    pub config_hash: u32,
}

/// What stands for a configuration: the CRC-32 of its bytes by `control::wire`.
pub fn config_hash(config: &Config) -> u32 {
    CRC.checksum(&encode_config(config))
}

impl<'a> Hello<'a> {
    pub(crate) fn encode(&self, to: &mut Writer<'_>) {
        to.u32(self.config_hash);
        [self.image, self.version, self.commit].into_iter().for_each(|text| to.text([text].into_iter()));
    }

    pub(crate) fn decode(from: &mut Reader<'a>) -> Option<Self> {
        let config_hash = from.u32()?;
        Some(Self { image: from.text()?, version: from.text()?, commit: from.text()?, config_hash })
    }
}

/// What a fault record is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum FaultKind {
    /// A panic; the text tells where.
    Panic = 1,
    /// An exception of the core; the registers tell which.
    Exception = 2,
    /// The watchdog was not fed.
    Watchdog = 3,
    /// The controller went to `control::Mode::Fault`; the causes tell why. The program went on.
    Controller = 4,
    /// The supply went below what the chip needs.
    BrownOut = 5,
    /// The motor's bridge was opened until the next start, for the reason in the text. The program went on.
    Drive = 6,
}

impl FaultKind {
    /// The kind of a number on the wire.
    pub fn numbered(number: u8) -> Option<Self> {
        use FaultKind::*;
        [Panic, Exception, Watchdog, Controller, BrownOut, Drive]
            .into_iter()
            .find(|kind| *kind as u8 == number)
    }

    /// In words.
    pub const fn name(self) -> &'static str {
        match self {
            FaultKind::Panic => "panic",
            FaultKind::Exception => "exception",
            FaultKind::Watchdog => "watchdog",
            FaultKind::Controller => "controller",
            FaultKind::BrownOut => "brown-out",
            FaultKind::Drive => "drive",
        }
    }
}

/// Why the program was started.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum ResetCause {
    /// The board can't tell.
    #[default]
    Unknown = 0,
    /// Power came.
    PowerOn = 1,
    /// The supply was too low for a while.
    BrownOut = 2,
    /// The reset pin: a button or a debugger.
    Pin = 3,
    /// The program itself, as after a panic.
    Software = 4,
    /// A watchdog that was not fed.
    Watchdog = 5,
    /// A sleep that is not allowed.
    LowPower = 6,
}

impl ResetCause {
    /// The cause of a number on the wire.
    pub fn numbered(number: u8) -> Option<Self> {
        use ResetCause::*;
        let all = [Unknown, PowerOn, BrownOut, Pin, Software, Watchdog, LowPower];
        all.into_iter().find(|cause| *cause as u8 == number)
    }

    /// In words.
    pub const fn name(self) -> &'static str {
        match self {
            ResetCause::Unknown => "unknown",
            ResetCause::PowerOn => "power-on",
            ResetCause::BrownOut => "brown-out",
            ResetCause::Pin => "reset pin",
            ResetCause::Software => "software",
            ResetCause::Watchdog => "watchdog",
            ResetCause::LowPower => "low power",
        }
    }
}

/// Most bytes of a fault's text; a longer one is cut.
pub const FAULT_TEXT_BYTES: usize = 200;
/// Most bytes of a fault record on the wire.
pub const FAULT_BYTES: usize = 51 + 1 + FAULT_TEXT_BYTES;

/// A fault, as it was kept. What does not belong to its kind is 0 or empty.
///
/// Steps, time, mode and causes are those of the last control step before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaultRecord<'a> {
    /// What kind of fault.
    pub kind: FaultKind,
    /// Number of the program's start that recorded it, from 1; a watchdog's is recorded by the start after it.
    pub boot: u32,
    /// Why the program was started that time.
    pub reset: ResetCause,
    /// The controller's mode.
    pub mode: Mode,
    /// Control steps done.
    pub steps: u32,
    /// [`control::SensorFrame::now_us`] of the last frame \[us\], wrapping.
    pub frame_us: u32,
    /// The controller's causes.
    pub causes: Causes,
    /// The exception's number.
    pub exception: u32,
    /// The core's registers: configurable and hard fault status, bus fault address, stack pointer,
    /// program counter, link register.
    pub registers: [u32; 6],
    /// In words, cut to [`FAULT_TEXT_BYTES`].
    pub text: &'a str,
}

impl<'a> FaultRecord<'a> {
    pub(crate) fn encode(&self, to: &mut Writer<'_>) {
        to.u8(self.kind as u8);
        to.u32(self.boot);
        to.u8(self.reset as u8);
        to.u8(self.mode as u8);
        to.u32(self.steps);
        to.u32(self.frame_us);
        to.u64(self.causes.0);
        to.u32(self.exception);
        self.registers.into_iter().for_each(|register| to.u32(register));
        to.text([cut(self.text, FAULT_TEXT_BYTES)].into_iter());
    }

    pub(crate) fn decode(from: &mut Reader<'a>) -> Option<Self> {
        Some(Self {
            kind: FaultKind::numbered(from.u8()?)?,
            boot: from.u32()?,
            reset: ResetCause::numbered(from.u8()?)?,
            mode: telemetry::mode(from.u8()?)?,
            steps: from.u32()?,
            frame_us: from.u32()?,
            causes: Causes(from.u64()?),
            exception: from.u32()?,
            registers: [from.u32()?, from.u32()?, from.u32()?, from.u32()?, from.u32()?, from.u32()?],
            text: from.text()?,
        })
    }
}

/// One place of the faults that were kept, the newest at 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StoredFault<'a> {
    /// Its place.
    pub place: u16,
    /// How many are kept.
    pub total: u16,
    /// What is there; `None` past the end.
    pub record: Option<FaultRecord<'a>>,
}

impl<'a> StoredFault<'a> {
    pub(crate) fn encode(&self, to: &mut Writer<'_>) {
        to.u16(self.place);
        to.u16(self.total);
        if let Some(record) = &self.record {
            record.encode(to);
        }
    }

    pub(crate) fn decode(from: &mut Reader<'a>) -> Option<Self> {
        let (place, total) = (from.u16()?, from.u16()?);
        let record = if place < total { Some(FaultRecord::decode(from)?) } else { None };
        Some(Self { place, total, record })
    }
}

/// The first characters of `text` that take no more than `bytes`.
pub(crate) fn cut(text: &str, bytes: usize) -> &str {
    text.get(..text.floor_char_boundary(bytes)).unwrap_or_default()
}
