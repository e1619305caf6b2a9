//! Critical sections that leave the motor's interrupt alone.
//!
//! The usual one stops every interrupt, and a log line holds it for longer than the motor's loop may be late. This one
//! stops those that share anything by critical sections, which the motor's interrupt never does: it shares atomic words.

use super::priority::SHARED;
use cortex_m::register::{basepri, basepri_max};

struct Shared;
critical_section::set_impl!(Shared);

// SAFETY: every interrupt that enters a critical section has a priority of SHARED or below (`priority::set`), so none of
// them runs between acquire and release; there is one core. Sections nest: only the outermost lifts the mask.
unsafe impl critical_section::Impl for Shared {
    unsafe fn acquire() -> u8 {
        let before = basepri::read();
        basepri_max::write(SHARED as u8);
        core::sync::atomic::compiler_fence(core::sync::atomic::Ordering::SeqCst);
        before
    }

    unsafe fn release(before: u8) {
        core::sync::atomic::compiler_fence(core::sync::atomic::Ordering::SeqCst);
        // SAFETY: the mask as it was when this section began, which is what the contract of `release` asks for.
        unsafe { basepri::write(before) }
    }
}
