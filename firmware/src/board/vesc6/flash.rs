//! The flash of the parameters and the encoder's offset: three sectors of 16 KiB that `memory.x` keeps free of code.

use super::{pwm, shared, watchdog};
use core::ops::Range;
use embassy_stm32::flash::{Async, Bank1Region1, Error, Flash as Chip, InterruptHandler};
use embassy_stm32::pac;
use embassy_stm32::pac::flash::vals::Psize;
use embassy_stm32::peripherals::FLASH;
use embassy_stm32::{Peri, bind_interrupts};
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

bind_interrupts!(struct Lines { FLASH => InterruptHandler; });

/// Sectors 1 to 3. Sector 0 has the vector table.
const STORE: Range<u32> = 0x4000..0x1_0000;

/// The flash as the store sees it. The motor's bridge is open while it is written or erased, because the chip stands
/// still meanwhile and would not watch the current; so does the watchdog get more patience.
pub struct Flash(Bank1Region1<'static, Async>);

static FLASH_LEFT: Mutex<CriticalSectionRawMutex, core::cell::Cell<Option<Peri<'static, FLASH>>>> =
    Mutex::new(core::cell::Cell::new(None));

/// What unlocks the flash's control register.
const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];

/// Puts the peripheral where [`flash`] finds it.
pub(super) fn start(peripheral: Peri<'static, FLASH>) {
    FLASH_LEFT.lock(|left| left.set(Some(peripheral)));
}

/// The next erases are done by words, 0.5 s at most for a sector of 16 KiB; by bytes it is 0.8 s (data sheet of the
/// STM32F405, table 40). To be called before each: the HAL's writing sets the register back (embassy-stm32 0.6.0,
/// `flash/f4.rs`, `disable_write`; embassy's pull request 7046).
fn erase_by_words() {
    if pac::FLASH.cr().read().lock() {
        KEYS.into_iter().for_each(|key| pac::FLASH.keyr().write_value(key));
    }
    pac::FLASH.cr().modify(|w| w.set_psize(Psize::PSIZE32));
}

/// The flash, and the range in it that is the store's; `None` when it was given away already.
pub fn flash() -> Option<(Flash, Range<u32>)> {
    let peripheral = FLASH_LEFT.lock(core::cell::Cell::take)?;
    Some((Flash(Chip::new(peripheral, Lines).into_regions().bank1_region1), STORE))
}

/// While it lives the bridge is open, the watchdog patient and the data cache off. The cache keeps what an erase takes
/// away, and may be emptied only while it is off (RM0090, 3.6.4).
pub(super) struct Standstill;

impl Standstill {
    pub(super) fn begin() -> Self {
        // The interrupt would close it again, so that it is told first.
        shared::set_hold(true);
        pwm::open();
        watchdog::standstill(true);
        pac::FLASH.acr().modify(|w| w.set_dcen(false));
        Self
    }
}

impl Drop for Standstill {
    fn drop(&mut self) {
        pac::FLASH.acr().modify(|w| w.set_dcrst(true));
        pac::FLASH.acr().modify(|w| w.set_dcrst(false));
        pac::FLASH.acr().modify(|w| w.set_dcen(true));
        watchdog::standstill(false);
        shared::set_hold(false);
    }
}

impl ErrorType for Flash {
    type Error = Error;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = Bank1Region1::<Async>::READ_SIZE;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Error> {
        self.0.read(offset, bytes).await
    }

    fn capacity(&self) -> usize {
        self.0.capacity()
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = Bank1Region1::<Async>::WRITE_SIZE;
    const ERASE_SIZE: usize = Bank1Region1::<Async>::ERASE_SIZE;

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Error> {
        let _standstill = Standstill::begin();
        self.0.write(offset, bytes).await
    }

    /// Each sector is a standstill of its own: after 0.5 s of erasing control makes up for its steps, and three sectors in one
    /// would outlast the watchdog.
    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Error> {
        for sector in (from..to).step_by(Self::ERASE_SIZE) {
            let _standstill = Standstill::begin();
            erase_by_words();
            self.0.erase(sector, to.min(sector + Self::ERASE_SIZE as u32)).await?;
        }
        Ok(())
    }
}
