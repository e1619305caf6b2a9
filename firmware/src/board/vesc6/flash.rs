//! Flash driver for parameters and encoder offset: three sectors of 16 KiB that `memory.x` keeps free of code.

use super::{pwm, shared, watchdog};
use crate::heartbeat;
use crate::tasks::WATCHDOG;
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

/// Flash for the store. During write and erase the chip halts and the current is unmonitored, so the motor's bridge
/// is open. Used within a [`StoreGuard`].
pub struct Flash(Bank1Region1<'static, Async>);

static FLASH_LEFT: Mutex<CriticalSectionRawMutex, core::cell::Cell<Option<Peri<'static, FLASH>>>> =
    Mutex::new(core::cell::Cell::new(None));

/// Unlock keys of the flash control register.
const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];

/// Stores the peripheral for [`flash`].
pub(super) fn start(peripheral: Peri<'static, FLASH>) {
    FLASH_LEFT.lock(|left| left.set(Some(peripheral)));
}

/// Sets erasing by words, at most 0.5 s per sector of 16 KiB; by bytes it is 0.8 s (data sheet of the STM32F405,
/// table 40). Call before each erase: the HAL's write resets the register (embassy-stm32 0.6.0, `flash/f4.rs`,
/// `disable_write`; embassy pull request 7046).
fn erase_by_words() {
    if pac::FLASH.cr().read().lock() {
        KEYS.into_iter().for_each(|key| pac::FLASH.keyr().write_value(key));
    }
    pac::FLASH.cr().modify(|w| w.set_psize(Psize::PSIZE32));
}

/// The flash and the store's range in it; `None` if already taken.
pub fn flash() -> Option<(Flash, Range<u32>)> {
    let peripheral = FLASH_LEFT.lock(core::cell::Cell::take)?;
    Some((Flash(Chip::new(peripheral, Lines).into_regions().bank1_region1), STORE))
}

/// Guard of a store: while it exists the bridge is open and the watchdog's timeout extended. The searches of a store
/// and its halts keep the lowest priority from feeding for longer than the short timeout.
pub struct StoreGuard(());

impl StoreGuard {
    /// Opens the bridge and extends the timeout.
    pub fn begin() -> Self {
        hold_open();
        watchdog::set_timeout(watchdog::EXTENDED);
        Self(())
    }
}

impl Drop for StoreGuard {
    fn drop(&mut self) {
        watchdog::set_timeout(WATCHDOG);
        shared::set_hold(false);
    }
}

/// Opens the bridge until it is released; returns whether it was held open before.
fn hold_open() -> bool {
    // First, as the motor interrupt would close the bridge again.
    let held = shared::set_hold(true);
    pwm::open();
    held
}

/// Guard of a write or erase: while it exists the bridge is open and the data cache off. The cache keeps erased data,
/// and can be reset only while it is off (RM0090, 3.6.4). Its start and end feed the watchdog while the supervision is
/// suspended, which is limited: a store without end is reset.
pub(super) struct FlashStall {
    held: bool,
}

impl FlashStall {
    pub(super) fn begin() -> Self {
        let held = hold_open();
        feed();
        pac::FLASH.acr().modify(|w| w.set_dcen(false));
        Self { held }
    }
}

impl Drop for FlashStall {
    fn drop(&mut self) {
        pac::FLASH.acr().modify(|w| w.set_dcrst(true));
        pac::FLASH.acr().modify(|w| w.set_dcrst(false));
        pac::FLASH.acr().modify(|w| w.set_dcen(true));
        feed();
        shared::set_hold(self.held);
    }
}

fn feed() {
    if heartbeat::is_suspended() {
        watchdog::feed_watchdog();
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
        let _stall = FlashStall::begin();
        self.0.write(offset, bytes).await
    }

    /// Erases sector by sector: after each, a halt of 0.5 s, control catches up on its steps; three sectors at once
    /// would exceed the watchdog's timeout.
    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Error> {
        for sector in (from..to).step_by(Self::ERASE_SIZE) {
            let _stall = FlashStall::begin();
            erase_by_words();
            self.0.erase(sector, to.min(sector + Self::ERASE_SIZE as u32)).await?;
        }
        Ok(())
    }
}
