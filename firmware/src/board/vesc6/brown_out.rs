//! Supply warning: 3.3 V has fallen below the highest threshold, 2.9 V in the reference manual (3.03 V in the data
//! sheet of the STM32F427), and some time is left. The brown-out reset is below it: 2.8 V if the option bytes are set
//! so; 168 MHz and programming by words need 2.7 V (data sheet of the STM32F405).

use super::flash::FlashStall;
use super::watchdog;
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::InterruptExt;
use embassy_stm32::pac::{EXTI, FLASH, PWR};

/// EXTI line of the voltage detector, and its highest threshold.
const LINE: usize = 16;
const V2_9: u8 = 7;

/// Brown-out level 3 in the option bytes, 2.8 V. The values 1 and 2 are lower levels; 3, as delivered, is off.
const LEVEL_3: u8 = 0;

/// Unlock keys of the option bytes.
const KEYS: [u32; 2] = [0x0819_2a3b, 0x4c5d_6e7f];

/// Waits for the supply voltage, and starts the warning.
pub(super) fn start() {
    PWR.cr1().modify(|w| {
        w.set_pls(V2_9);
        w.set_pvde(true);
    });
    while PWR.csr1().read().pvdo() {}
    let level = FLASH.optcr().read().bor_lev();
    if level != LEVEL_3 {
        defmt::warn!(
            "supply: brown-out reset at {=u8}, of 0 (2.8 V) wanted: run the alignment image once",
            level
        );
    }
    // The detector's output rises when the supply falls.
    EXTI.rtsr(0).modify(|w| w.set_line(LINE, true));
    EXTI.imr(0).modify(|w| w.set_line(LINE, true));
    // SAFETY: critical sections mask its priority; only the handler below runs.
    unsafe { interrupt::PVD.enable() }
}

/// Sets the brown-out reset to level 3 permanently; effective from the next reset (RM0090, 3.7.2). For the bench
/// only: a power failure during this call can leave the chip read-protected, and a debug probe must then erase it.
/// The bridge is open meanwhile.
pub fn raise_level() {
    if FLASH.optcr().read().bor_lev() == LEVEL_3 {
        return;
    }
    watchdog::feed_watchdog();
    let _stall = FlashStall::begin();
    KEYS.into_iter().for_each(|key| FLASH.optkeyr().write_value(key));
    while FLASH.sr().read().bsy() {}
    FLASH.optcr().modify(|w| w.set_bor_lev(LEVEL_3));
    FLASH.optcr().modify(|w| w.set_optstrt(true));
    while FLASH.sr().read().bsy() {}
    FLASH.optcr().modify(|w| w.set_optlock(true));
    defmt::info!("supply: brown-out reset set to 2.8 V, from the next reset on");
}

#[interrupt]
fn PVD() {
    EXTI.pr(0).write(|w| w.set_line(LINE, true));
    crate::crash::brown_out()
}
