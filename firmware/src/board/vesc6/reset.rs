//! Why the chip started, and starting it anew.

use crate::crash::Registers;
use crate::retained;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use embassy_stm32::pac::RCC;
use embassy_stm32::pac::rcc::regs::Csr;
use link::fault_log;
use link::report::{FaultKind, ResetCause};

/// Bit that no reset cause has: the register was read.
const READ: u32 = 1;

/// The register as it was at the start; 0 before it was read.
static FOUND: AtomicU32 = AtomicU32::new(0);

/// Why the chip started. The register is read and cleared once; the answer stays the same.
pub fn reset_cause() -> ResetCause {
    if FOUND.load(Ordering::Relaxed) == 0 {
        FOUND.store(RCC.csr().read().0 | READ, Ordering::Relaxed);
        RCC.csr().modify(|w| w.set_rmvf(true));
    }
    let found = Csr(FOUND.load(Ordering::Relaxed));
    // The pin is pulled by every other reset as well, and brown-out is told with power-on.
    match found {
        f if f.lpwrrstf() => ResetCause::LowPower,
        f if f.wdgrstf() || f.wwdgrstf() => ResetCause::Watchdog,
        f if f.sftrstf() => ResetCause::Software,
        f if f.porrstf() => ResetCause::PowerOn,
        f if f.borrstf() => ResetCause::BrownOut,
        _ => ResetCause::Pin,
    }
}

/// The newest fault that was kept, over RTT: the last words themselves are lost with the log's buffer, which each start
/// empties, and a watchdog's reset has none.
pub fn log_kept_fault() {
    retained::with(|memory| {
        let Some(fault) = fault_log::faults(memory).next() else { return };
        defmt::warn!(
            "newest fault, of start {=u32} after {=str}: {=str}: {=str} mode={=str} steps={=u32} causes={=u64:#x} exception={=u32} \
             cfsr, hfsr, bfar, sp, pc, lr: {:08x}",
            fault.boot,
            fault.reset.name(),
            fault.kind.name(),
            fault.text,
            fault.mode.name(),
            fault.steps,
            fault.causes.0,
            fault.exception,
            fault.registers
        );
    });
}

/// Whether the last words are being said.
static ENDING: AtomicBool = AtomicBool::new(false);

/// The last words over RTT, then a new start. Without them where saying them is what failed: a log line that breaks off
/// can't be followed by another.
pub fn end(kind: FaultKind, registers: &Registers, words: &str) -> ! {
    if ENDING.swap(true, Ordering::Relaxed) {
        cortex_m::peripheral::SCB::sys_reset()
    }
    defmt::error!(
        "{=str}: {=str} exception={=u32} registers={:08x}",
        kind.name(),
        words,
        registers.exception,
        registers.values
    );
    cortex_m::peripheral::SCB::sys_reset()
}
