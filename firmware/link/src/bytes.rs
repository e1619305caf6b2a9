//! Bounds-checked writer and reader of little-endian bytes.

/// Bits of a limit that is off: a NaN that no parameter can have.
const OFF: u32 = u32::MAX;

/// Writes values in order. A value that does not fit is not written; [`Writer::used`] then returns `None`.
#[derive(Debug)]
pub struct Writer<'a> {
    to: &'a mut [u8],
    used: usize,
    full: bool,
}

impl<'a> Writer<'a> {
    /// Writes from the start of `to`.
    pub fn new(to: &'a mut [u8]) -> Self {
        Self { to, used: 0, full: false }
    }

    /// Number of bytes written; `None` if a value did not fit.
    pub fn used(&self) -> Option<usize> {
        (!self.full).then_some(self.used)
    }

    /// The bytes written; `None` if a value did not fit.
    pub fn finish(self) -> Option<&'a [u8]> {
        let used = self.used()?;
        self.to.get(..used)
    }

    /// Raw bytes.
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

    /// The bits of an `f32`.
    pub fn f32(&mut self, value: f32) {
        self.put(&value.to_le_bytes());
    }

    /// The bits of an `f32` that can be off (`None`).
    pub fn scalar(&mut self, value: Option<f32>) {
        self.u32(to_bits(value));
    }

    /// A text of up to 255 bytes, given in `parts`, preceded by its length. A longer text counts as not fitting.
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

/// Reads values in order; `None` past the end.
#[derive(Clone, Copy, Debug)]
pub struct Reader<'a>(pub &'a [u8]);

impl<'a> Reader<'a> {
    /// The next `N` raw bytes, borrowed.
    pub fn chunk<const N: usize>(&mut self) -> Option<&'a [u8; N]> {
        let (bytes, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(bytes)
    }

    /// The next `N` raw bytes, copied.
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

    /// An `f32`; any bit pattern is accepted.
    pub fn f32(&mut self) -> Option<f32> {
        self.take().map(f32::from_le_bytes)
    }

    /// An `f32` that can be off (`None`).
    pub fn scalar(&mut self) -> Option<Option<f32>> {
        self.u32().map(from_bits)
    }

    /// A text preceded by its length; `None` also when the bytes are not UTF-8.
    pub fn text(&mut self) -> Option<&'a str> {
        let length = self.u8()?;
        let (text, rest) = self.0.split_at_checked(usize::from(length))?;
        self.0 = rest;
        core::str::from_utf8(text).ok()
    }
}

/// Bits of a number that can be off.
pub fn to_bits(value: Option<f32>) -> u32 {
    value.map_or(OFF, f32::to_bits)
}

/// Number that can be off, from its bits.
pub fn from_bits(bits: u32) -> Option<f32> {
    (bits != OFF).then_some(f32::from_bits(bits))
}
