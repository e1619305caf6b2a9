//! Whatever goes wrong ends QEMU with a report and a status that is not zero.
#![allow(unsafe_code)]

use super::Exit;
use super::semihosting::exit;
use core::panic::PanicInfo;
use cortex_m::peripheral::SCB;
use cortex_m_semihosting::hprintln;

// A fault may come from a stack that has run out: report on a fresh one.
core::arch::global_asm!(
    ".macro fault name",
    ".global \\name",
    ".type \\name,%function",
    ".thumb_func",
    "\\name:",
    "mrs r0, msp",
    "mrs r1, ipsr",
    "ldr r2, =_stack_start",
    "msr msp, r2",
    "b fault_report",
    ".endm",
    "fault HardFault",
    "fault MemoryManagement",
    "fault BusFault",
    "fault UsageFault",
    ".ltorg",
);

/// Gives each kind of fault its own exception, so that the report names it.
pub fn enable() {
    const SHCSR_ALL_FAULTS: u32 = 0b111 << 16;
    // SAFETY: sets bits of the core's own register that nothing else writes.
    unsafe { (*SCB::PTR).shcsr.modify(|bits| bits | SHCSR_ALL_FAULTS) }
}

/// Cause registers: ARMv7-M Architecture Reference Manual, B3.2.15 to B3.2.18.
#[unsafe(no_mangle)]
extern "C" fn fault_report(sp: u32, exception: u32) -> ! {
    // SAFETY: the core's own registers, reading them has no effect.
    let [cfsr, hfsr, bfar] = [0xE000_ED28, 0xE000_ED2C, 0xE000_ED38]
        .map(|at: usize| unsafe { (at as *const u32).read_volatile() });
    hprintln!(
        "fault: exception={} cfsr={:08x} hfsr={:08x} bfar={:08x} sp={:08x}",
        exception,
        cfsr,
        hfsr,
        bfar,
        sp
    );
    exit(Exit::Fault)
}

#[cortex_m_rt::exception]
unsafe fn DefaultHandler(interrupt: i16) -> ! {
    hprintln!("stray interrupt {}", interrupt);
    exit(Exit::StrayInterrupt)
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    hprintln!("{}", info);
    exit(Exit::Panic)
}
