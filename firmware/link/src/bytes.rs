//! Little-endian bytes, written and read in order, never beyond their end.

/// Bits that stand for a limit that is off: a NaN that no parameter may have.
const OFF: u32 = u32::MAX;

/// Writes in order. What does not fit is not written, and [`Writer::used`] then says `None`.
#[derive(Debug)]
pub struct Writer<'a> {
    to: &'a mut [u8],
    used: usize,
    full: bool,
}

impl<'a> Writer<'a> {
    /// From the start of `to`.
    pub fn new(to: &'a mut [u8]) -> Self {
        Self { to, used: 0, full: false }
    }

    /// How many bytes were written; `None` if not all found room.
    pub fn used(&self) -> Option<usize> {
        (!self.full).then_some(self.used)
    }

    /// What was written; `None` if not all found room.
    pub fn finish(self) -> Option<&'a [u8]> {
        let used = self.used()?;
        self.to.get(..used)
    }

    /// Bytes as they are.
    pub fn put(&mut self, bytes: &[u8]) {
        match self.to.get_mut(self.used..).and_then(|room| room.get_mut(..bytes.len())) {
            Some(place) => {
                place.copy_from_slice(bytes);
                self.used += bytes.len();
            }
            None => self.full = true,
        }
    }

    /// One byte.
    pub fn u8(&mut self, value: u8) {
        self.put(&[value]);
    }

    /// Two bytes.
    pub fn u16(&mut self, value: u16) {
        self.put(&value.to_le_bytes());
    }

    /// Four bytes.
    pub fn u32(&mut self, value: u32) {
        self.put(&value.to_le_bytes());
    }

    /// Eight bytes.
    pub fn u64(&mut self, value: u64) {
        self.put(&value.to_le_bytes());
    }

    /// The bits of a number.
    pub fn f32(&mut self, value: f32) {
        self.put(&value.to_le_bytes());
    }

    /// The bits of a number that may be off.
    pub fn scalar(&mut self, value: Option<f32>) {
        self.u32(to_bits(value));
    }

    /// A text of up to 255 bytes in `parts`, its length first. A longer one counts as no room.
    pub fn text<'t>(&mut self, parts: impl Iterator<Item = &'t str> + Clone) {
        let length: usize = parts.clone().map(str::len).sum();
        match u8::try_from(length) {
            Ok(length) => {
                self.u8(length);
                parts.for_each(|part| self.put(part.as_bytes()));
            }
            Err(_) => self.full = true,
        }
    }
}

/// Reads in order; `None` past the end.
#[derive(Clone, Copy, Debug)]
pub struct Reader<'a>(pub &'a [u8]);

impl<'a> Reader<'a> {
    /// `N` bytes as they are, where they are.
    pub fn chunk<const N: usize>(&mut self) -> Option<&'a [u8; N]> {
        let (bytes, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(bytes)
    }

    /// `N` bytes as they are.
    pub fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.chunk().copied()
    }

    /// One byte.
    pub fn u8(&mut self) -> Option<u8> {
        self.take().map(u8::from_le_bytes)
    }

    /// Two bytes.
    pub fn u16(&mut self) -> Option<u16> {
        self.take().map(u16::from_le_bytes)
    }

    /// Four bytes.
    pub fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    /// Eight bytes.
    pub fn u64(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    /// A number, any bit pattern.
    pub fn f32(&mut self) -> Option<f32> {
        self.take().map(f32::from_le_bytes)
    }

    /// A number that may be off.
    pub fn scalar(&mut self) -> Option<Option<f32>> {
        self.u32().map(from_bits)
    }

    /// A text with its length first; `None` also when it is not UTF-8.
    pub fn text(&mut self) -> Option<&'a str> {
        let length = self.u8()?;
        let (text, rest) = self.0.split_at_checked(usize::from(length))?;
        self.0 = rest;
        core::str::from_utf8(text).ok()
    }
}

/// The bits of a number that may be off.
pub fn to_bits(value: Option<f32>) -> u32 {
    value.map_or(OFF, f32::to_bits)
}

/// A number that may be off, of its bits.
pub fn from_bits(bits: u32) -> Option<f32> {
    (bits != OFF).then_some(f32::from_bits(bits))
}
