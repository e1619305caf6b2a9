//! What stands still while a debugger halts the core.

use embassy_stm32::pac::DBGMCU;

/// Stops TIM1 with the core, which opens all six switches (RM0090, 17.3.21: its outputs are off as without MOE): the
/// last duty cycles must not go on without the loop that watches the current. Stops the watchdog and every clock of the
/// program as well, so that the program finds no time missed. The bits are those of RM0090, 38.16.4 and 38.16.5.
pub(super) fn start() {
    DBGMCU.apb2fzr().modify(|w| w.set_tim1(true));
    DBGMCU.apb1fzr().modify(|w| {
        w.set_iwdg(true);
        w.set_tim3(true);
        w.set_tim4(true);
        w.set_tim5(true);
    });
}
