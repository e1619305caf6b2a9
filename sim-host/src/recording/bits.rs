//! Extracts a number from bits of a CAN frame.

/// Bit order of a signal, numbered as in a DBC: bit 0 of byte 0 is 0, of byte 1 is 8.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Intel: the start is the lowest bit; the next higher bit has the next number.
    Little,
    /// Motorola: the start is the highest bit; the next lower one is below it in the byte, then at the top of the next
    /// byte.
    Big,
}

/// Position of a signal in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Its start bit.
    pub start: u16,
    /// Number of bits, 1 to 64.
    pub bits: u8,
    /// Its bit order.
    pub order: Order,
}

impl Place {
    /// Bytes that a frame must have to contain it.
    pub fn bytes(&self) -> usize {
        let first = usize::from(self.start);
        let bits = usize::from(self.bits);
        match self.order {
            Order::Little => (first + bits).div_ceil(8),
            // Counted from the top of its first byte.
            Order::Big => first / 8 + (7 - first % 8 + bits).div_ceil(8),
        }
    }

    /// The number in its bits; `None` if the frame is too short.
    pub fn of(&self, data: &[u8]) -> Option<u64> {
        if data.len() < self.bytes() {
            return None;
        }
        let first = usize::from(self.start);
        let bit = |n: usize| u64::from(data[n / 8] >> (n % 8) & 1);
        let number = match self.order {
            Order::Little => (0..usize::from(self.bits)).fold(0, |all, i| all | bit(first + i) << i),
            Order::Big => {
                let top = first / 8 * 8 + 7 - first % 8;
                // Bits counted from the top of the frame.
                (0..usize::from(self.bits))
                    .fold(0, |all, i| all << 1 | bit((top + i) / 8 * 8 + 7 - (top + i) % 8))
            }
        };
        Some(number)
    }
}

/// `number`, whose low `bits` bits are in two's complement, as a signed integer.
pub fn signed(number: u64, bits: u8) -> i64 {
    let unused = 64 - u32::from(bits.clamp(1, 64));
    (number << unused) as i64 >> unused
}
