//! Restart by the core's reset request, which QEMU implements. RCC's reset cause is not modelled; the program stores
//! the cause in memory that survives the reset.
#![allow(unsafe_code)]

use super::time;
use crate::retained::USED;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use link::report::ResetCause;

/// Words for the next start: magic number, cause, time.
type Word = [u32; 3];
/// Offset in the retained memory: behind fault log and flash.
const AT: usize = 31 << 10;
const _: () = assert!(USED + (25 << 10) <= AT);
/// Magic number: this program stored the cause.
const MARK: u32 = 0x5253_5431;

unsafe extern "C" {
    #[link_name = "_retained_start"]
    static mut RETAINED: [u8; AT + size_of::<Word>()];
}

/// Whether failures restart the chip rather than end QEMU.
static RESTARTS: AtomicBool = AtomicBool::new(false);
/// Time of QEMU at this start \[ms\].
static BEFORE_MS: AtomicU32 = AtomicU32::new(0);

fn word() -> *mut Word {
    // The address is a multiple of 4: the memory's start and AT are.
    (&raw mut RETAINED).cast::<u8>().wrapping_add(AT).cast()
}

/// Makes failures restart the chip.
pub fn restarts() {
    RESTARTS.store(true, Ordering::Relaxed);
}

/// Whether failures restart the chip.
pub(super) fn does_restart() -> bool {
    RESTARTS.load(Ordering::Relaxed)
}

/// Cause of the start; call once.
pub fn reset_cause() -> ResetCause {
    // SAFETY: aligned memory that nothing else uses; any bits are valid words.
    let [mark, cause, before_ms] = unsafe { word().read_volatile() };
    if mark != MARK {
        return ResetCause::PowerOn;
    }
    BEFORE_MS.store(before_ms, Ordering::Relaxed);
    // SAFETY: as above.
    unsafe { word().write_volatile([0; 3]) };
    ResetCause::numbered(cause as u8).unwrap_or_default()
}

/// Time since QEMU's start \[ms\].
pub(super) fn total_ms() -> u32 {
    BEFORE_MS.load(Ordering::Relaxed).wrapping_add(time::milliseconds())
}

/// Restarts the chip, for this cause.
pub(super) fn reset(cause: ResetCause) -> ! {
    // SAFETY: as above.
    unsafe { word().write_volatile([MARK, cause as u32, total_ms()]) };
    cortex_m::peripheral::SCB::sys_reset()
}

/// No effect: this board has no motor.
pub fn outputs_off() {}
