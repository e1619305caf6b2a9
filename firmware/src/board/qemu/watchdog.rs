//! Simulated independent watchdog, which QEMU does not model: checked by the clock's interrupt, it resets the chip or
//! ends QEMU.

use super::semihosting::exit;
use super::{Exit, reset, text, time};
use crate::tasks::WATCHDOG;
use core::sync::atomic::{AtomicU32, Ordering};
use link::report::ResetCause;

static FED_MS: AtomicU32 = AtomicU32::new(0);

/// Restarts the watchdog's timeout.
pub fn feed_watchdog() {
    FED_MS.store(time::milliseconds(), Ordering::Relaxed);
}

/// Resets if the watchdog was not fed within its timeout.
pub(super) fn check(now_ms: u32) {
    let hungry_ms = now_ms.saturating_sub(FED_MS.load(Ordering::Relaxed));
    if u64::from(hungry_ms) > WATCHDOG.as_millis() {
        if reset::does_restart() {
            reset::reset(ResetCause::Watchdog)
        }
        text::line(format_args!("watchdog: control stood still, {now_ms} ms after start"));
        exit(Exit::Watchdog)
    }
}
