//! Parameters and encoder offset that are in flash before power-on, written with the board's own store.

use control::Config;
use embassy_futures::block_on;
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use link::Store;
use link::alignment::Alignment;
use link::store::{NotStored, StoreBuffers};
use std::ops::Range;

/// Sectors 1 to 3 of the flash, which hold the store (docs/hardware.md).
const STORE: Range<u32> = 0x4000..0x1_0000;

/// Content of the store's sectors with this configuration and encoder offset \[electrical turns\], for
/// [`crate::Bench::power_on_with_store`].
///
/// # Errors
/// An invalid configuration.
pub fn stored(config: &Config, offset_turns: f32) -> Result<Vec<u8>, NotStored> {
    let erased = Flash(vec![0xff; STORE.end as usize]);
    let mut store = Store::new(erased, STORE).ok_or(NotStored::Flash)?;
    let buffers = &mut StoreBuffers::new();
    block_on(store.save(config, buffers))?;
    let alignment = Alignment { offset_turns, motor_id: devices::vesc6::MOTOR.motor_id() };
    block_on(store.save_alignment(&alignment, buffers))?;
    Ok(store.into_flash().0.split_off(STORE.start as usize))
}

/// The flash up to the store's end; writing only clears bits.
struct Flash(Vec<u8>);

impl Flash {
    fn range(&mut self, offset: u32, length: usize) -> Result<&mut [u8], NorFlashErrorKind> {
        let from = offset as usize;
        self.0.get_mut(from..from + length).ok_or(NorFlashErrorKind::OutOfBounds)
    }
}

impl ErrorType for Flash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        bytes.copy_from_slice(self.range(offset, bytes.len())?);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.len()
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = 16 << 10;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        self.range(from, to.saturating_sub(from) as usize)?.fill(0xff);
        Ok(())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        self.range(offset, bytes.len())?.iter_mut().zip(bytes).for_each(|(cell, byte)| *cell &= byte);
        Ok(())
    }
}
