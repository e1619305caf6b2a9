//! Ends an emulator that does not answer in time.

use std::process::Child;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::spawn;
use std::time::Duration;

/// Checks periodically, in its own thread, whether an exchange takes too long, so that the exchange itself needs no
/// further system call.
#[derive(Debug)]
pub(super) struct Watchdog {
    pub(super) limit: Duration,
    state: Arc<WatchdogState>,
    /// Dropping it ends the thread.
    _running: Sender<()>,
}

#[derive(Debug, Default)]
struct WatchdogState {
    /// The number of the exchange under way; 0 when there is none.
    under_way: AtomicU64,
    /// Whether the emulator was ended by the watchdog.
    ended: AtomicBool,
}

impl Watchdog {
    /// Ends the emulator when an exchange takes longer than `limit`, at the latest after twice that time.
    pub(super) fn new(child: Arc<Mutex<Child>>, limit: Duration) -> Self {
        let (running, ended) = channel();
        let state = Arc::new(WatchdogState::default());
        let looking = Arc::clone(&state);
        spawn(move || {
            let mut before = 0;
            while ended.recv_timeout(limit) == Err(RecvTimeoutError::Timeout) {
                let now = looking.under_way.load(Ordering::Relaxed);
                if now != 0 && now == before {
                    looking.ended.store(true, Ordering::Relaxed);
                    // It may have ended already.
                    let _ = locked(&child).kill();
                    return;
                }
                before = now;
            }
        });
        Self { limit, state, _running: running }
    }

    /// Marks the start of an exchange; `number` is above 0 and differs each time.
    pub(super) fn begin(&self, number: u64) {
        self.state.under_way.store(number, Ordering::Relaxed);
    }

    /// Marks the end of the exchange.
    pub(super) fn end(&self) {
        self.state.under_way.store(0, Ordering::Relaxed);
    }

    /// Whether the watchdog ended the emulator.
    pub(super) fn ended(&self) -> bool {
        self.state.ended.load(Ordering::Relaxed)
    }
}

/// Locks the mutex, even if a thread panicked while holding it.
pub(super) fn locked<T>(what: &Mutex<T>) -> MutexGuard<'_, T> {
    what.lock().unwrap_or_else(PoisonError::into_inner)
}
