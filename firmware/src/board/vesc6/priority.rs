//! Interrupt priorities.

use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};

/// Motor loop: above everything, critical sections included.
const MOTOR: Priority = Priority::P1;
/// Highest priority that critical sections mask; the supply warning.
pub(super) const SHARED: Priority = Priority::P2;
/// Clock that wakes the tasks.
const CLOCK: Priority = Priority::P3;
/// Executor of the control task.
const CONTROL: Priority = Priority::P4;
/// All others.
pub(super) const REST: Priority = Priority::P8;

/// Number of interrupts of the chip.
const INTERRUPTS: usize = 82;

/// Sets the priority of every interrupt. After reset all have the highest one, which critical sections do not mask.
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
