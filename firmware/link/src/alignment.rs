//! The stored offset of the motor's encoder, and the choice between the stored offset and the program's.

use crate::bytes::{Reader, Writer};
use crate::record::{InvalidRecord, NoRecord};
use core::fmt;

/// Version of the record's layout; records of another layout are not read.
pub const LAYOUT: u8 = 1;
/// Bytes in flash: layout, record number, motor, offset.
pub const ALIGNMENT_BYTES: usize = 1 + 4 + 4 + 4;

/// Result of a successful alignment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alignment {
    /// Encoder offset, used as `motor::encoder::EncoderConfig::offset_turns` \[electrical turns, -0.5 to 0.5\].
    pub offset_turns: f32,
    /// Motor and encoder of the alignment: `motor::Config::motor_id`.
    pub motor_id: u32,
}

impl Alignment {
    /// Encodes the record. `number` increases by one with each stored record.
    pub fn encode(&self, number: u32) -> [u8; ALIGNMENT_BYTES] {
        let mut bytes = [0; ALIGNMENT_BYTES];
        let mut writer = Writer::new(&mut bytes);
        writer.u8(LAYOUT);
        writer.u32(number);
        writer.u32(self.motor_id);
        writer.f32(self.offset_turns);
        bytes
    }

    /// Decodes a record into its number and alignment. Bytes after the known ones are ignored.
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

/// The encoder offset at start, and its source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Offset {
    /// From the program \[electrical turns\].
    Program(f32),
    /// From the alignment in flash \[electrical turns\].
    Flash(f32),
    /// None: no alignment is stored.
    NoneStored,
    /// None: the alignment in flash belongs to another motor or encoder.
    OtherMotor,
    /// None: the alignment in flash is invalid.
    Invalid(InvalidRecord),
}

impl Offset {
    /// Chooses the offset: the program's takes precedence; the stored one is used only if its motor is `motor_id`.
    pub fn choose(
        program: Option<f32>,
        stored: Result<Option<Alignment>, InvalidRecord>,
        motor_id: u32,
    ) -> Self {
        match (program, stored) {
            (Some(turns), _) => Offset::Program(turns),
            (None, Err(invalid)) => Offset::Invalid(invalid),
            (None, Ok(None)) => Offset::NoneStored,
            (None, Ok(Some(found))) if found.motor_id == motor_id => Offset::Flash(found.offset_turns),
            (None, Ok(Some(_))) => Offset::OtherMotor,
        }
    }

    /// The offset \[electrical turns\]; `None` if unknown: the motor then gives no torque.
    pub fn turns(&self) -> Option<f32> {
        match *self {
            Offset::Program(turns) | Offset::Flash(turns) => Some(turns),
            Offset::NoneStored | Offset::OtherMotor | Offset::Invalid(_) => None,
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
            Offset::Invalid(InvalidRecord::Unreadable) => write!(f, "flash can't be read"),
            Offset::Invalid(InvalidRecord::Lost) => write!(f, "the newest one is lost"),
            Offset::Invalid(InvalidRecord::NoRecord(NoRecord::Layout(layout))) => {
                write!(f, "stored in layout {layout}, which is not known")
            }
            Offset::Invalid(
                InvalidRecord::NoRecord(NoRecord::Malformed) | InvalidRecord::Inconsistent(_),
            ) => {
                write!(f, "the stored one is damaged")
            }
        }
    }
}
