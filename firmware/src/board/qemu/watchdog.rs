//! Stands in for the chip's independent watchdog, which QEMU does not have: looked at by the clock's
//! interrupt, it ends QEMU where the chip would reset.

use super::semihosting::exit;
use super::{Exit, time};
use crate::tasks::WATCHDOG;
use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m_semihosting::hprintln;

static FED_MS: AtomicU32 = AtomicU32::new(0);

/// Starts the watchdog's patience anew.
pub fn feed_watchdog() {
    FED_MS.store(time::milliseconds(), Ordering::Relaxed);
}

/// Bites when it was not fed for longer than its patience.
pub(super) fn check(now_ms: u32) {
    if u64::from(now_ms.saturating_sub(FED_MS.load(Ordering::Relaxed))) > WATCHDOG.as_millis() {
        hprintln!("watchdog: control stood still, {} ms after start", now_ms);
        exit(Exit::Watchdog)
    }
}
