//! Channels of a group: position and meaning of their bits in a record.

use super::block::File;
use super::conversion::Conversion;

/// Largest depth of nested structures.
const DEEPEST: u8 = 4;

/// A channel.
#[derive(Clone, Debug)]
pub(super) struct Channel {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) kind: Kind,
    /// Data type: 0 to 5 are numbers.
    data_type: u8,
    bit_offset: u32,
    pub(super) byte_offset: usize,
    pub(super) bits: u32,
    flags: u32,
    invalidation_bit: usize,
    /// Target of its data link.
    pub(super) data: Option<usize>,
    pub(super) conversion: Result<Conversion, &'static str>,
    /// Whether it has parts: those of a structure, which are channels themselves, or of an array.
    parts: bool,
    array: bool,
}

/// Purpose of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A value in each record.
    Value,
    /// Bytes elsewhere; the record has their position.
    Variable,
    /// The time \[s\] of each record.
    Time,
    /// The time, computed from the record's number.
    CountedTime,
    /// A value computed from the record's number.
    Counted,
    /// Anything else, such as an angle as master.
    Other,
}

/// All channels of a list, those of structures after the structure itself.
pub(super) fn list(file: &mut File, first: Option<usize>) -> Vec<Channel> {
    let mut channels = Vec::new();
    nested(file, first, DEEPEST, &mut channels);
    channels
}

fn nested(file: &mut File, first: Option<usize>, depth: u8, channels: &mut Vec<Channel>) {
    let mut next = first;
    while let Some(block) = next.and_then(|at| file.once(at, b"##CN")) {
        next = block.link(0);
        let (kind, sync) = (block.u8(0), block.u8(1));
        let kind = match (kind, sync) {
            (0 | 4 | 5, _) => Kind::Value,
            (1, _) => Kind::Variable,
            (2, 1) => Kind::Time,
            (3, 1) => Kind::CountedTime,
            (6, _) => Kind::Counted,
            _ => Kind::Other,
        };
        let parts = block.link(1);
        let unit = file.text(block.link(6));
        let of_conversion =
            || block.link(4).and_then(|at| file.block(at, b"##CC")).and_then(|block| block.link(1));
        let unit = if unit.is_empty() { file.text(of_conversion()) } else { unit };
        let structure = parts.is_some_and(|at| file.block(at, b"##CN").is_some());
        channels.push(Channel {
            name: file.text(block.link(2)),
            unit,
            kind,
            data_type: block.u8(2),
            bit_offset: u32::from(block.u8(3)),
            byte_offset: block.u32(4) as usize,
            bits: block.u32(8),
            flags: block.u32(12),
            invalidation_bit: block.u32(16) as usize,
            data: block.link(5),
            conversion: Conversion::of(file, block.link(4)),
            parts: structure,
            array: parts.is_some() && !structure,
        });
        if structure && depth > 0 {
            nested(file, parts, depth - 1, channels);
        }
    }
}

impl Channel {
    /// Whether its values are numbers.
    pub(super) fn is_number(&self) -> bool {
        let whole = matches!(self.data_type, 0..=3) && (1..=64).contains(&self.bits) && self.bit_offset < 8;
        let float = matches!(self.data_type, 4 | 5) && matches!(self.bits, 32 | 64);
        let counted = matches!(self.kind, Kind::Counted | Kind::CountedTime);
        !self.array && (counted || !matches!(self.kind, Kind::Variable | Kind::Other) && (whole || float))
    }

    /// Whether it is a structure; its parts are channels themselves.
    pub(super) fn is_structure(&self) -> bool {
        self.parts
    }

    /// Its bits in a record, as an unsigned number; `None` for more than 64 bits or bits beyond the record.
    pub(super) fn bits_of(&self, record: &[u8]) -> Option<u64> {
        if !(1..=64).contains(&self.bits) || self.bit_offset > 7 {
            return None;
        }
        let bytes = (self.bit_offset + self.bits).div_ceil(8) as usize;
        let bytes = record.get(self.byte_offset..)?.get(..bytes)?;
        let join = |all: u128, byte: &u8| all << 8 | u128::from(*byte);
        let all = match self.data_type {
            1 | 3 | 5 => bytes.iter().fold(0, join),
            _ => bytes.iter().rev().fold(0, join),
        };
        let mask = u64::MAX >> (64 - self.bits);
        Some((all >> self.bit_offset) as u64 & mask)
    }

    /// Its value in record `number`, in its unit; NaN if the record marks it as invalid. The invalidation bits follow
    /// the `data_bytes` of the record.
    pub(super) fn value(&self, number: usize, record: &[u8], data_bytes: usize) -> f64 {
        let invalid = match self.flags & 3 {
            0 => false,
            2 => {
                let byte = record.get(data_bytes + self.invalidation_bit / 8);
                byte.is_some_and(|byte| byte >> (self.invalidation_bit % 8) & 1 == 1)
            }
            _ => true,
        };
        let Ok(conversion) = &self.conversion else { return f64::NAN };
        if invalid {
            return f64::NAN;
        }
        let raw = match self.kind {
            Kind::Counted | Kind::CountedTime => Some(number as f64),
            _ => self.bits_of(record.get(..data_bytes).unwrap_or(record)).map(|bits| self.raw(bits)),
        };
        raw.map_or(f64::NAN, |raw| conversion.value(raw))
    }

    fn raw(&self, bits: u64) -> f64 {
        match (self.data_type, self.bits) {
            (0 | 1, _) => bits as f64,
            (2 | 3, n) => super::super::bits::signed(bits, n as u8) as f64,
            (_, 32) => f64::from(f32::from_bits(bits as u32)),
            _ => f64::from_bits(bits),
        }
    }
}
