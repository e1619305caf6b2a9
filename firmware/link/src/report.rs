//! Who the board is, and what went wrong with it.

use crate::bytes::{Reader, Writer};
use crate::frame::CRC;
use control::wire::encode_config;
use control::{Causes, Config};

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

/// What ended the program the last time.
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
}

impl FaultKind {
    /// The kind of a number on the wire.
    pub const fn numbered(number: u8) -> Option<Self> {
        Some(match number {
            1 => FaultKind::Panic,
            2 => FaultKind::Exception,
            3 => FaultKind::Watchdog,
            4 => FaultKind::Controller,
            _ => return None,
        })
    }
}

/// A fault, as it was kept. What does not belong to its kind is 0 or empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaultRecord<'a> {
    /// What kind of fault.
    pub kind: FaultKind,
    /// Control steps done before it.
    pub steps: u32,
    /// The controller's causes at the last step.
    pub causes: Causes,
    /// The exception's number.
    pub exception: u32,
    /// The core's registers: configurable and hard fault status, bus fault address, stack pointer,
    /// program counter, link register.
    pub registers: [u32; 6],
    /// In words, cut to what a frame holds.
    pub text: &'a str,
}

impl<'a> FaultRecord<'a> {
    pub(crate) fn encode(&self, to: &mut Writer<'_>) {
        to.u8(self.kind as u8);
        to.u32(self.steps);
        to.u64(self.causes.0);
        to.u32(self.exception);
        self.registers.into_iter().for_each(|register| to.u32(register));
        to.text([cut(self.text, 255)].into_iter());
    }

    pub(crate) fn decode(from: &mut Reader<'a>) -> Option<Self> {
        Some(Self {
            kind: FaultKind::numbered(from.u8()?)?,
            steps: from.u32()?,
            causes: Causes(from.u64()?),
            exception: from.u32()?,
            registers: [from.u32()?, from.u32()?, from.u32()?, from.u32()?, from.u32()?, from.u32()?],
            text: from.text()?,
        })
    }
}

/// The first characters of `text` that take no more than `bytes`.
pub(crate) fn cut(text: &str, bytes: usize) -> &str {
    text.get(..text.floor_char_boundary(bytes)).unwrap_or_default()
}
