//! Simulated independent watchdog, which QEMU does not model: checked by the clock's interrupt, it resets the chip or
//! ends QEMU.

use super::semihosting::exit;
use super::{Exit, reset, text, time};
use crate::tasks::WATCHDOG;
use core::sync::atomic::{AtomicU32, Ordering};
use link::report::ResetCause;

/// Timeouts \[ms\]: the usual one, and that in a store, as on the board.
const SHORT_MS: u32 = WATCHDOG.as_millis() as u32;
const EXTENDED_MS: u32 = 2000;

static FED_MS: AtomicU32 = AtomicU32::new(0);
static TIMEOUT_MS: AtomicU32 = AtomicU32::new(SHORT_MS);

/// Guard of a store: while it exists the timeout is extended.
pub struct StoreGuard(());

impl StoreGuard {
    /// Extends the timeout.
    pub fn begin() -> Self {
        set_timeout(EXTENDED_MS);
        Self(())
    }
}

impl Drop for StoreGuard {
    fn drop(&mut self) {
        set_timeout(SHORT_MS);
    }
}

/// Sets the timeout and restarts the count.
fn set_timeout(timeout_ms: u32) {
    feed_watchdog();
    TIMEOUT_MS.store(timeout_ms, Ordering::Relaxed);
}

/// Restarts the watchdog's timeout.
pub fn feed_watchdog() {
    FED_MS.store(time::milliseconds(), Ordering::Relaxed);
}

/// Resets if the watchdog was not fed within its timeout.
pub(super) fn check(now_ms: u32) {
    let hungry_ms = now_ms.saturating_sub(FED_MS.load(Ordering::Relaxed));
    if hungry_ms > TIMEOUT_MS.load(Ordering::Relaxed) {
        if reset::does_restart() {
            reset::reset(ResetCause::Watchdog)
        }
        text::line(format_args!("watchdog: control stood still, {now_ms} ms after start"));
        exit(Exit::Watchdog)
    }
}
