//! Whatever goes wrong starts the chip anew where the image says so, else it ends QEMU with a report and a status that is
//! not zero.
#![allow(unsafe_code)]

use super::semihosting::exit;
use super::{Exit, reset, text};
use crate::crash::{self, Registers};
use core::fmt::Write;
use core::panic::PanicInfo;
use cortex_m::peripheral::SCB;
use heapless::String;
use link::report::{FAULT_TEXT_BYTES, FaultKind};

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
    text::line(format_args!(
        "fault: exception={exception} cfsr={cfsr:08x} hfsr={hfsr:08x} bfar={bfar:08x} sp={sp:08x}"
    ));
    if reset::does_restart() {
        let [pc, lr] = stacked(sp).unwrap_or_default();
        crash::end(FaultKind::Exception, Registers { exception, values: [cfsr, hfsr, bfar, sp, pc, lr] }, "")
    }
    exit(Exit::Fault)
}

/// Where it happened and who called, as the core stacked them; `None` if they lie outside the stack.
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

/// Reads memory that is not there.
pub(super) fn touch_nothing() -> ! {
    // SAFETY: there is no memory at this address; the bus fault is the point.
    unsafe { core::hint::black_box((0x6000_0000 as *const u32).read_volatile()) };
    unreachable!("the read is a bus fault")
}

#[cortex_m_rt::exception]
unsafe fn DefaultHandler(interrupt: i16) -> ! {
    text::line(format_args!("stray interrupt {interrupt}"));
    if reset::does_restart() {
        let exception = (interrupt + 16) as u32;
        crash::end(FaultKind::Exception, Registers { exception, values: [0; 6] }, "stray interrupt")
    }
    exit(Exit::StrayInterrupt)
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    text::line(format_args!("{info}"));
    if reset::does_restart() {
        let mut words = String::<FAULT_TEXT_BYTES>::new();
        // What does not fit is cut.
        let _ = write!(words, "{info}");
        crash::end(FaultKind::Panic, Registers::default(), &words)
    }
    exit(Exit::Panic)
}
