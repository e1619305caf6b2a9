//! The supply's warning: 3.3 V has fallen to 2.9 V, and some time is left.

use embassy_stm32::interrupt;
use embassy_stm32::interrupt::InterruptExt;
use embassy_stm32::pac::{EXTI, PWR};

/// The line of the voltage detector, and the highest of its thresholds.
const LINE: usize = 16;
const V2_9: u8 = 7;

/// Waits until the supply is there, and starts the watch.
pub(super) fn start() {
    PWR.cr1().modify(|w| {
        w.set_pls(V2_9);
        w.set_pvde(true);
    });
    while PWR.csr1().read().pvdo() {}
    // Its output rises when the supply falls.
    EXTI.rtsr(0).modify(|w| w.set_line(LINE, true));
    EXTI.imr(0).modify(|w| w.set_line(LINE, true));
    // SAFETY: its priority is one that critical sections stop; the handler below is all that runs.
    unsafe { interrupt::PVD.enable() }
}

#[interrupt]
fn PVD() {
    EXTI.pr(0).write(|w| w.set_line(LINE, true));
    crate::crash::brown_out()
}
