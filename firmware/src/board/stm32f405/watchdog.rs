//! The independent watchdog: runs from its own oscillator and can't be stopped once started.

use crate::tasks::WATCHDOG;
use core::cell::RefCell;
use embassy_stm32::Peri;
use embassy_stm32::peripherals::IWDG;
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;

type Dog = IndependentWatchdog<'static, IWDG>;

static DOG: Mutex<CriticalSectionRawMutex, RefCell<Option<Dog>>> = Mutex::new(RefCell::new(None));

/// Starts it: from now on the chip resets unless [`feed_watchdog`] is called in time.
pub(super) fn start(peripheral: Peri<'static, IWDG>) {
    let mut dog = IndependentWatchdog::new(peripheral, WATCHDOG.as_micros() as u32);
    dog.unleash();
    DOG.lock(|cell| cell.replace(Some(dog)));
}

/// Starts the watchdog's patience anew.
pub fn feed_watchdog() {
    DOG.lock(|cell| {
        if let Some(dog) = cell.borrow_mut().as_mut() {
            dog.pet();
        }
    });
}
