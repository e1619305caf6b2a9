//! Critical sections that do not mask the motor interrupt.
//!
//! The usual implementation masks every interrupt, and a log line holds it for longer than the motor loop's delay
//! budget. This one masks the interrupts that use critical sections; the motor interrupt shares only atomic words.

use super::priority::SHARED;
use cortex_m::register::{basepri, basepri_max};

struct Shared;
critical_section::set_impl!(Shared);

// SAFETY: every interrupt that enters a critical section has priority SHARED or below (`priority::set`), so none of
// them runs between acquire and release; there is one core. Sections nest: only the outermost clears the mask.
unsafe impl critical_section::Impl for Shared {
    unsafe fn acquire() -> u8 {
        let before = basepri::read();
        basepri_max::write(SHARED as u8);
        core::sync::atomic::compiler_fence(core::sync::atomic::Ordering::SeqCst);
        before
    }

    unsafe fn release(before: u8) {
        core::sync::atomic::compiler_fence(core::sync::atomic::Ordering::SeqCst);
        // SAFETY: restores the mask from the start of this section, as the contract of `release` requires.
        unsafe { basepri::write(before) }
    }
}
