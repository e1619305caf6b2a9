//! Identity of the board, and its fault records.

use crate::bytes::{Reader, Writer};
use crate::frame::CRC;
use crate::telemetry;
use control::wire::{encode_causes, encode_config};
use control::{Causes, Config, Mode};

/// Identity of the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hello<'a> {
    /// Name of the image.
    pub image: &'a str,
    /// Version of the firmware.
    pub version: &'a str,
    /// Commit it was built from.
    pub commit: &'a str,
    /// [`config_hash`] of the configuration in use.
    pub config_hash: u32,
}

/// Hash of a configuration: the CRC-32 of its encoding by `control::wire`.
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

control::numbered! {
    /// Kind of a fault record.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum FaultKind {
        /// A panic; the text has the place.
        Panic = 1,
        /// A processor exception; the registers have the details.
        Exception = 2,
        /// The watchdog was not fed.
        Watchdog = 3,
        /// The controller entered `control::Mode::Fault`, for the recorded causes. The firmware kept running.
        Controller = 4,
        /// The supply voltage fell below the chip's limit.
        BrownOut = 5,
        /// The motor's bridge was opened until the next start, for the reason in the text. The firmware kept running.
        Drive = 6,
    }
}

impl FaultKind {
    /// Name for display.
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

control::numbered! {
    /// Cause of the last reset.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum ResetCause {
        /// The board does not report the cause.
        #[default]
        Unknown = 0,
        /// Power-on.
        PowerOn = 1,
        /// Brown-out.
        BrownOut = 2,
        /// The reset pin: a button or a debugger.
        Pin = 3,
        /// Software reset, for example after a panic.
        Software = 4,
        /// Watchdog timeout.
        Watchdog = 5,
        /// Illegal entry into a low-power mode.
        LowPower = 6,
    }
}

impl ResetCause {
    /// Name for display.
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

/// Largest text of a fault \[bytes\]; longer texts are cut.
pub const FAULT_TEXT_BYTES: usize = 200;
/// Largest fault record on the wire \[bytes\].
pub const FAULT_BYTES: usize = 59 + 1 + FAULT_TEXT_BYTES;

/// A stored fault. Fields that do not apply to its kind are 0 or empty.
///
/// Steps, time, mode and causes are those of the last control step before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaultRecord<'a> {
    /// Kind of the fault.
    pub kind: FaultKind,
    /// Number of the start that recorded the fault, from 1; a watchdog reset is recorded by the start after it.
    pub boot: u32,
    /// Reset cause of that start.
    pub reset: ResetCause,
    /// The controller's mode.
    pub mode: Mode,
    /// Number of control steps.
    pub steps: u32,
    /// [`control::SensorFrame::now_us`] of the last frame \[us\], wrapping.
    pub frame_us: u32,
    /// The controller's causes.
    pub causes: Causes,
    /// Exception number.
    pub exception: u32,
    /// Core registers: configurable and hard fault status, bus fault address, stack pointer, program counter, link
    /// register.
    pub registers: [u32; 6],
    /// Text, cut to [`FAULT_TEXT_BYTES`].
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
        to.put(&encode_causes(self.causes));
        to.u32(self.exception);
        self.registers.into_iter().for_each(|register| to.u32(register));
        to.text([cut(self.text, FAULT_TEXT_BYTES)].into_iter());
    }

    pub(crate) fn decode(from: &mut Reader<'a>) -> Option<Self> {
        Some(Self {
            kind: FaultKind::numbered(from.u8()?)?,
            boot: from.u32()?,
            reset: ResetCause::numbered(from.u8()?)?,
            mode: Mode::numbered(from.u8()?)?,
            steps: from.u32()?,
            frame_us: from.u32()?,
            causes: telemetry::causes(from)?,
            exception: from.u32()?,
            registers: [from.u32()?, from.u32()?, from.u32()?, from.u32()?, from.u32()?, from.u32()?],
            text: from.text()?,
        })
    }
}

/// Answer to a request for a stored fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StoredFault<'a> {
    /// Index of the fault, 0 for the newest.
    pub place: u16,
    /// Number of stored faults.
    pub total: u16,
    /// The record; `None` past the end.
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

/// Longest prefix of `text` of at most `bytes` bytes.
pub(crate) fn cut(text: &str, bytes: usize) -> &str {
    text.get(..text.floor_char_boundary(bytes)).unwrap_or_default()
}
