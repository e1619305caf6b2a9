//! What a fault of the core, or a panic, which ends in one, does first: outputs off. Then the chip starts anew.

use cortex_m_rt::{ExceptionFrame, exception};

#[exception]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    super::restart()
}
