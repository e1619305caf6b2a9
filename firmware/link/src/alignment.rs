//! The offset of the motor's encoder: as an alignment found it, and which one is used.

use crate::bytes::{Reader, Writer};
use crate::record::NoRecord;
use crate::store::Doubt;
use core::fmt;

/// The layout of its bytes. Another one is not read.
pub const LAYOUT: u8 = 1;
/// Bytes in flash: layout, number, motor, offset.
pub const ALIGNMENT_BYTES: usize = 1 + 4 + 4 + 4;

/// What a successful alignment leaves behind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alignment {
    /// The offset found, as `motor::encoder::EncoderConfig::offset_turns` \[electrical turns, -0.5 to 0.5\].
    pub offset_turns: f32,
    /// The motor and encoder it was found with: `motor::Config::motor_id`.
    pub motor_id: u32,
}

impl Alignment {
    /// Its bytes. Each that is stored has a larger number than that before.
    pub fn encode(&self, number: u32) -> [u8; ALIGNMENT_BYTES] {
        let mut bytes = [0; ALIGNMENT_BYTES];
        let mut writer = Writer::new(&mut bytes);
        writer.u8(LAYOUT);
        writer.u32(number);
        writer.u32(self.motor_id);
        writer.f32(self.offset_turns);
        bytes
    }

    /// Number and alignment of their bytes. Bytes after those that are known are passed over.
    ///
    /// # Errors
    /// Another layout, too few bytes, or an offset outside its range.
    pub fn decode(bytes: &[u8]) -> Result<(u32, Self), NoRecord> {
        let mut from = Reader(bytes);
        match from.u8() {
            None => Err(NoRecord::Malformed),
            Some(LAYOUT) => parts(&mut from).ok_or(NoRecord::Malformed),
            Some(other) => Err(NoRecord::Layout(other)),
        }
    }
}

fn parts(from: &mut Reader<'_>) -> Option<(u32, Alignment)> {
    let (number, motor_id, offset_turns) = (from.u32()?, from.u32()?, from.f32()?);
    (-0.5..=0.5).contains(&offset_turns).then_some((number, Alignment { offset_turns, motor_id }))
}

/// The offset a program begins with, and where it is from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Offset {
    /// Written down in the program \[electrical turns\].
    Program(f32),
    /// Of the alignment in flash \[electrical turns\].
    Flash(f32),
    /// None: no alignment was ever stored.
    NoneStored,
    /// None: the alignment in flash is that of another motor or encoder.
    OtherMotor,
    /// None: the alignment in flash is not believed.
    Doubt(Doubt),
}

impl Offset {
    /// The program's own before that in flash, and that only if it was found with this motor.
    pub fn choose(program: Option<f32>, stored: Result<Option<Alignment>, Doubt>, motor_id: u32) -> Self {
        match (program, stored) {
            (Some(turns), _) => Offset::Program(turns),
            (None, Err(doubt)) => Offset::Doubt(doubt),
            (None, Ok(None)) => Offset::NoneStored,
            (None, Ok(Some(found))) if found.motor_id == motor_id => Offset::Flash(found.offset_turns),
            (None, Ok(Some(_))) => Offset::OtherMotor,
        }
    }

    /// The offset \[electrical turns\]; `None`: not known, the motor gives no torque.
    pub fn turns(&self) -> Option<f32> {
        match *self {
            Offset::Program(turns) | Offset::Flash(turns) => Some(turns),
            Offset::NoneStored | Offset::OtherMotor | Offset::Doubt(_) => None,
        }
    }
}

impl fmt::Display for Offset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Offset::Program(turns) => write!(f, "{turns:.4} turns, from the program"),
            Offset::Flash(turns) => write!(f, "{turns:.4} turns, from flash"),
            Offset::NoneStored => write!(f, "none stored"),
            Offset::OtherMotor => write!(f, "the stored one is of another motor, not used"),
            Offset::Doubt(Doubt::Unreadable) => write!(f, "flash can't be read"),
            Offset::Doubt(Doubt::Lost) => write!(f, "the newest one is lost"),
            Offset::Doubt(Doubt::NoRecord(NoRecord::Layout(layout))) => {
                write!(f, "stored in layout {layout}, which is not known")
            }
            Offset::Doubt(Doubt::NoRecord(NoRecord::Malformed) | Doubt::Unfit(_)) => {
                write!(f, "the stored one is damaged")
            }
        }
    }
}
