//! Starting anew: by the core's own request, which QEMU follows. RCC's cause of a reset is not modelled; the
//! program leaves word of it in memory that the reset keeps.
#![allow(unsafe_code)]

use super::time;
use crate::retained::USED;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use link::report::ResetCause;

/// A word left for the next start: mark, cause, time.
type Word = [u32; 3];
/// Where it lies in the retained memory: behind the ring and the flash.
const AT: usize = 31 << 10;
const _: () = assert!(USED + (25 << 10) <= AT);
/// Says that the word was left by this program.
const MARK: u32 = 0x5253_5431;

unsafe extern "C" {
    #[link_name = "_retained_start"]
    static mut RETAINED: [u8; AT + size_of::<Word>()];
}

/// Whether the chip starts anew after a failure, rather than end QEMU.
static RESTARTS: AtomicBool = AtomicBool::new(false);
/// Time of QEMU before this start \[ms\].
static BEFORE_MS: AtomicU32 = AtomicU32::new(0);

fn word() -> *mut Word {
    // The address is a multiple of 4: the memory's start and AT are.
    (&raw mut RETAINED).cast::<u8>().wrapping_add(AT).cast()
}

/// From now on failures start the chip anew.
pub fn restarts() {
    RESTARTS.store(true, Ordering::Relaxed);
}

/// Whether failures start the chip anew.
pub(super) fn does_restart() -> bool {
    RESTARTS.load(Ordering::Relaxed)
}

/// Why the chip started, to be asked once.
pub fn reset_cause() -> ResetCause {
    // SAFETY: aligned memory of nobody else; any bits are words.
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

/// Starts the chip anew, for this cause.
pub(super) fn reset(cause: ResetCause) -> ! {
    // SAFETY: as above.
    unsafe { word().write_volatile([MARK, cause as u32, total_ms()]) };
    cortex_m::peripheral::SCB::sys_reset()
}

/// The motor is off: there is none.
pub fn outputs_off() {}
