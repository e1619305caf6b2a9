//! Handlers of panics, exceptions and unexpected interrupts, for every board: all end in [`crash::end`].
#![allow(unsafe_code)]

use crate::board;
use crate::crash::{self, Registers};
use core::fmt::Write;
use core::panic::PanicInfo;
use cortex_m::peripheral::SCB;
use heapless::String;
use link::report::{FAULT_TEXT_BYTES, FaultKind};

// After a stack overflow the handler continues on a fresh stack. Otherwise it keeps the stack with the registers that
// the core saved.
core::arch::global_asm!(
    ".macro fault name",
    ".global \\name",
    ".type \\name,%function",
    ".thumb_func",
    "\\name:",
    "mrs r0, msp",
    "mrs r1, ipsr",
    "ldr r2, =_stack_end",
    "add.w r2, r2, #2048",
    "cmp r0, r2",
    "bhs 1f",
    "ldr r2, =_stack_start",
    "msr msp, r2",
    "1: b fault_report",
    ".endm",
    "fault HardFault",
    "fault MemoryManagement",
    "fault BusFault",
    "fault UsageFault",
    ".ltorg",
);

/// Enables a separate exception for each kind of fault, so that the record names it.
pub fn enable() {
    const SHCSR_ALL_FAULTS: u32 = 0b111 << 16;
    // SAFETY: sets bits of a core register that nothing else writes.
    unsafe { (*SCB::PTR).shcsr.modify(|bits| bits | SHCSR_ALL_FAULTS) }
}

/// Cause registers: ARMv7-M Architecture Reference Manual, B3.2.15 to B3.2.18.
#[unsafe(no_mangle)]
extern "C" fn fault_report(sp: u32, exception: u32) -> ! {
    // SAFETY: reading core registers has no side effect.
    let [cfsr, hfsr, bfar] = [0xE000_ED28, 0xE000_ED2C, 0xE000_ED38]
        .map(|at: usize| unsafe { (at as *const u32).read_volatile() });
    let [pc, lr] = stacked(sp).unwrap_or_default();
    crash::end(FaultKind::Exception, Registers { exception, values: [cfsr, hfsr, bfar, sp, pc, lr] }, "")
}

/// Program counter and link register that the core stacked; `None` if they lie outside the stack.
fn stacked(sp: u32) -> Option<[u32; 2]> {
    unsafe extern "C" {
        static _stack_start: u8;
        static _stack_end: u8;
    }
    let (top, end) = (&raw const _stack_start as u32, &raw const _stack_end as u32);
    let inside = sp >= end && sp.is_multiple_of(4) && sp.checked_add(32)? <= top;
    // SAFETY: aligned words of the stack.
    inside.then(|| [24, 20].map(|at| unsafe { ((sp + at) as *const u32).read_volatile() }))
}

#[cortex_m_rt::exception]
unsafe fn DefaultHandler(interrupt: i16) -> ! {
    let exception = (i32::from(interrupt) + 16) as u32;
    crash::end(FaultKind::Exception, Registers { exception, values: [0; 6] }, "stray interrupt")
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    board::outputs_off();
    let mut text = String::<FAULT_TEXT_BYTES>::new();
    // Longer text is cut.
    let _ = write!(text, "{info}");
    crash::end(FaultKind::Panic, Registers::default(), &text)
}
