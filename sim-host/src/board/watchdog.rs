//! Ends an emulator that does not answer.

use std::process::Child;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::spawn;
use std::time::Duration;

/// Looks now and then, in a thread of its own, whether an exchange takes too long, so that the exchange itself
/// costs no further call of the system.
#[derive(Debug)]
pub(super) struct Watchdog {
    pub(super) limit: Duration,
    state: Arc<WatchdogState>,
    /// Closed, it ends the thread.
    _running: Sender<()>,
}

#[derive(Debug, Default)]
struct WatchdogState {
    /// The number of the exchange under way; 0 when there is none.
    under_way: AtomicU64,
    /// The emulator was ended.
    ended: AtomicBool,
}

impl Watchdog {
    /// Ends the emulator when an exchange lasts longer than `limit`, at the latest after twice that.
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
                    // It may have ended by itself.
                    let _ = locked(&child).kill();
                    return;
                }
                before = now;
            }
        });
        Self { limit, state, _running: running }
    }

    /// An exchange begins; `number` is above 0 and another one each time.
    pub(super) fn begin(&self, number: u64) {
        self.state.under_way.store(number, Ordering::Relaxed);
    }

    /// It is done.
    pub(super) fn end(&self) {
        self.state.under_way.store(0, Ordering::Relaxed);
    }

    /// Whether the emulator was ended.
    pub(super) fn ended(&self) -> bool {
        self.state.ended.load(Ordering::Relaxed)
    }
}

/// What it holds, whatever happened to a thread that held it.
pub(super) fn locked<T>(what: &Mutex<T>) -> MutexGuard<'_, T> {
    what.lock().unwrap_or_else(PoisonError::into_inner)
}
