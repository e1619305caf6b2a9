//! Who may interrupt whom.

use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};

/// The motor's loop: above everything, critical sections included.
const MOTOR: Priority = Priority::P1;
/// The first one that critical sections stop; the supply's warning.
pub(super) const SHARED: Priority = Priority::P2;
/// The clock that wakes the tasks.
const CLOCK: Priority = Priority::P3;
/// Control's executor.
const CONTROL: Priority = Priority::P4;
/// Whatever else.
pub(super) const REST: Priority = Priority::P8;

/// Interrupts of the chip, by their numbers.
const INTERRUPTS: usize = 82;

/// Gives every interrupt its priority. Out of reset all have the highest one, which critical sections do not stop.
pub(super) fn set(core: &mut cortex_m::Peripherals) {
    for line in 0..INTERRUPTS {
        // SAFETY: no interrupt is enabled yet, so none can run while a critical section relies on its priority.
        unsafe { core.NVIC.ipr[line].write(REST as u8) }
    }
    interrupt::ADC.set_priority(MOTOR);
    interrupt::PVD.set_priority(SHARED);
    interrupt::TIM5.set_priority(CLOCK);
    interrupt::UART5.set_priority(CONTROL);
}
