//! Reset cause, and restart of the chip.

use crate::crash::Registers;
use crate::retained;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use embassy_stm32::pac::RCC;
use embassy_stm32::pac::rcc::regs::Csr;
use link::fault_log;
use link::report::{FaultKind, ResetCause};

/// Marker bit outside the reset causes: the register was read.
const READ: u32 = 1;

/// The register at the start; 0 before it was read.
static FOUND: AtomicU32 = AtomicU32::new(0);

/// Cause of the start. The register is read and cleared once; later calls return the same.
pub fn reset_cause() -> ResetCause {
    if FOUND.load(Ordering::Relaxed) == 0 {
        FOUND.store(RCC.csr().read().0 | READ, Ordering::Relaxed);
        RCC.csr().modify(|w| w.set_rmvf(true));
    }
    let found = Csr(FOUND.load(Ordering::Relaxed));
    // Every reset sets the pin flag too, and brown-out comes with power-on.
    match found {
        f if f.lpwrrstf() => ResetCause::LowPower,
        f if f.wdgrstf() || f.wwdgrstf() => ResetCause::Watchdog,
        f if f.sftrstf() => ResetCause::Software,
        f if f.porrstf() => ResetCause::PowerOn,
        f if f.borrstf() => ResetCause::BrownOut,
        _ => ResetCause::Pin,
    }
}

/// Logs the newest stored fault over RTT: its own last log line is lost, as each start clears the log buffer, and a
/// watchdog reset has none.
pub fn log_stored_fault() {
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

/// Whether the last log line is being written.
static ENDING: AtomicBool = AtomicBool::new(false);

/// Writes the last log line over RTT, then restarts. If logging itself failed, restarts without one, as an
/// interrupted log line can't be followed by another.
pub fn end(kind: FaultKind, registers: &Registers, text: &str) -> ! {
    if ENDING.swap(true, Ordering::Relaxed) {
        cortex_m::peripheral::SCB::sys_reset()
    }
    defmt::error!(
        "{=str}: {=str} exception={=u32} registers={:08x}",
        kind.name(),
        text,
        registers.exception,
        registers.values
    );
    cortex_m::peripheral::SCB::sys_reset()
}
