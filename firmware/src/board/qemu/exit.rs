//! End of the program: a restart where the image chose it, else QEMU's end with a non-zero status.
#![allow(unsafe_code)]

use super::semihosting::exit;
use super::{Exit, reset, text};
use crate::crash::Registers;
use link::report::{FaultKind, ResetCause};

/// Exceptions from this number on are interrupts.
const INTERRUPTS: u32 = 16;

/// Writes the last log line, then restarts or ends QEMU.
pub fn end(kind: FaultKind, registers: &Registers, words: &str) -> ! {
    let Registers { exception, values: [cfsr, hfsr, bfar, sp, ..] } = *registers;
    let status = match kind {
        FaultKind::Exception if exception < INTERRUPTS => {
            text::line(format_args!(
                "fault: exception={exception} cfsr={cfsr:08x} hfsr={hfsr:08x} bfar={bfar:08x} sp={sp:08x}"
            ));
            Exit::Fault
        }
        FaultKind::Exception => {
            text::line(format_args!("{words} {}", exception - INTERRUPTS));
            Exit::StrayInterrupt
        }
        _ => {
            text::line(format_args!("{words}"));
            Exit::Panic
        }
    };
    if reset::does_restart() {
        reset::reset(ResetCause::Software)
    }
    exit(status)
}

/// Reads unmapped memory.
pub(super) fn touch_nothing() -> ! {
    // SAFETY: there is no memory at this address; the bus fault is the point.
    unsafe { core::hint::black_box((0x6000_0000 as *const u32).read_volatile()) };
    unreachable!("the read is a bus fault")
}
