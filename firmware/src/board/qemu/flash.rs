//! Simulated flash: memory that survives a reset, but not QEMU's end. Write and erase follow the chip's rules, but
//! take no time.
#![allow(unsafe_code)]

use super::fault_injection;
use crate::retained::USED;
use core::future::pending;
use core::ops::Range;
use embedded_storage_async::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

const PAGE: usize = 8 << 10;
const PAGES: usize = 3;
const BYTES: usize = PAGE * PAGES;
/// Magic number: the memory behind it was erased once.
const MARK: u32 = 0x464c_5348;

unsafe extern "C" {
    #[link_name = "_retained_start"]
    static mut RETAINED: [u8; USED + 4 + BYTES];
}

/// Three pages of memory.
pub struct Flash(&'static mut [u8; BYTES]);

/// An access outside the memory, or not aligned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wrong(NorFlashErrorKind);

impl NorFlashError for Wrong {
    fn kind(&self) -> NorFlashErrorKind {
        self.0
    }
}

impl Flash {
    /// The bytes of `from..to`, both multiples of `unit`.
    fn span(&mut self, from: usize, to: usize, unit: usize) -> Result<&mut [u8], Wrong> {
        if !from.is_multiple_of(unit) || !to.is_multiple_of(unit) {
            return Err(Wrong(NorFlashErrorKind::NotAligned));
        }
        self.0.get_mut(from..to).ok_or(Wrong(NorFlashErrorKind::OutOfBounds))
    }
}

/// The memory and the range for parameters; always present. Call once.
pub fn flash() -> Option<(Flash, Range<u32>)> {
    let at = (&raw mut RETAINED).cast::<u8>();
    // SAFETY: the linker script reserves this memory for the fault log and this function, which is called once and
    // uses only the part behind the log. It can hold any bytes; the compiler can't know that they are uninitialised.
    let (mark, bytes) =
        unsafe { (&mut *at.add(USED).cast::<[u8; 4]>(), &mut *at.add(USED + 4).cast::<[u8; BYTES]>()) };
    if *mark != MARK.to_le_bytes() {
        bytes.fill(0xff);
        *mark = MARK.to_le_bytes();
    }
    Some((Flash(bytes), 0..BYTES as u32))
}

impl ErrorType for Flash {
    type Error = Wrong;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Wrong> {
        let from = offset as usize;
        bytes.copy_from_slice(self.span(from, from + bytes.len(), Self::READ_SIZE)?);
        Ok(())
    }

    fn capacity(&self) -> usize {
        BYTES
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = PAGE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Wrong> {
        self.span(from as usize, to as usize, PAGE)?.fill(0xff);
        Ok(())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Wrong> {
        if fault_injection::flash_is_stuck() {
            pending::<()>().await;
        }
        let from = offset as usize;
        let places = self.span(from, from + bytes.len(), Self::WRITE_SIZE)?;
        // Programming only clears bits.
        places.iter_mut().zip(bytes).for_each(|(place, byte)| *place &= byte);
        Ok(())
    }
}
