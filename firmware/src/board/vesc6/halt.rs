//! Peripherals that stop while a debugger halts the core.

use embassy_stm32::pac::DBGMCU;

/// Stops TIM1 with the core, which opens all six switches (RM0090, 17.3.21: its outputs are off as without MOE), as
/// duty cycles must not continue without the current loop. Also stops the watchdog and every timer, so that no time
/// passes for the program. Bits: RM0090, 38.16.4 and 38.16.5.
pub(super) fn start() {
    DBGMCU.apb2fzr().modify(|w| w.set_tim1(true));
    DBGMCU.apb1fzr().modify(|w| {
        w.set_iwdg(true);
        w.set_tim3(true);
        w.set_tim4(true);
        w.set_tim5(true);
    });
}
