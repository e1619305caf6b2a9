//! A number in a CAN frame: its place, its codes and what they mean.

use micromath::F32;

/// A number in a frame. Little-endian: bit `n` is bit `n % 8` of byte `n / 8`.
#[derive(Clone, Copy, Debug)]
pub struct Signal {
    /// Name in databases.
    pub name: &'static str,
    /// Lowest bit.
    pub start: u8,
    /// Number of bits, 1 to 64.
    pub bits: u8,
    /// What the bits mean.
    pub content: Content,
    /// Meaning, in one sentence.
    pub meaning: &'static str,
}

/// What the bits of a signal mean.
#[derive(Clone, Copy, Debug)]
pub enum Content {
    /// A quantity.
    Quantity(Quantity),
    /// Yes or no.
    Flag,
    /// A whole number without unit.
    Count,
    /// The number of a choice, with the choices' names.
    Choice(fn(u8) -> Option<&'static str>),
    /// A set, one bit per element.
    Set(fn(u8) -> Option<Element>),
}

/// Codes of a quantity; two's complement if one of them is negative.
#[derive(Clone, Copy, Debug)]
pub struct Quantity {
    /// One step of the code, in units of `unit`.
    pub step: f32,
    /// The unit; empty for a fraction.
    pub unit: &'static str,
    /// Codes of the smallest and of the largest value; beyond them a value saturates.
    pub codes: (i16, i16),
    /// Code of a value that is not known.
    pub unknown: i16,
}

/// An element of a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Element {
    /// Name in databases.
    pub name: &'static str,
    /// Meaning, in one sentence.
    pub meaning: &'static str,
}

impl Signal {
    /// A number in its place; bits beyond its own are dropped.
    pub(super) const fn put(&self, number: u64) -> u64 {
        (number & self.mask()) << self.start
    }

    /// The number in a frame's bits.
    pub(super) const fn get(&self, frame: u64) -> u64 {
        frame >> self.start & self.mask()
    }

    const fn mask(&self) -> u64 {
        u64::MAX >> (64 - self.bits)
    }
}

impl Quantity {
    /// The code of a value, rounded and saturated; NaN is not known.
    pub(super) fn code(&self, value: Option<f32>) -> u64 {
        let code = match value {
            Some(value) if !value.is_nan() => {
                (F32(value / self.step).round().0 as i16).max(self.codes.0).min(self.codes.1)
            }
            _ => self.unknown,
        };
        // The sign's bits beyond the signal's own are dropped by its place.
        i64::from(code) as u64
    }

    /// The value of a code; `None` if it is not known.
    pub(super) fn value(&self, code: i16) -> Option<f32> {
        (code != self.unknown).then(|| f32::from(code) * self.step)
    }
}
