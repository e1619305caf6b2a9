//! Embassy's time driver on SysTick: 168 counts of the 168 MHz processor clock per microsecond. Alarms are at whole
//! milliseconds.
//!
//! The counter wraps once per millisecond of instructions and is not written after its start, as each write wakes
//! another QEMU thread, which takes longer than a control step. A skipped millisecond, or a time in which the clock
//! is stopped, is computed from the counter instead.
#![allow(unsafe_code)]

use super::watchdog;
use core::cell::RefCell;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use core::task::Waker;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{SCB, SYST};
use critical_section::Mutex;
use embassy_time_driver::Driver;
use embassy_time_queue_utils::Queue;

const COUNTS_PER_US: u32 = 168;
const COUNTS_PER_MS: u32 = 1000 * COUNTS_PER_US;

/// State of the clock. Accessed with interrupts disabled, except by the clock's interrupt.
struct SysTickClock {
    ms: AtomicU32,
    /// Counter at the start of this millisecond.
    from: AtomicU32,
    /// Wraps of the counter since.
    rounds: AtomicU32,
    /// Whether the clock is stopped.
    held: AtomicBool,
    /// Whether the time is read only at whole milliseconds.
    coarse: AtomicBool,
    queue: Mutex<RefCell<Queue>>,
}

embassy_time_driver::time_driver_impl!(static CLOCK: SysTickClock = SysTickClock {
    ms: AtomicU32::new(0),
    from: AtomicU32::new(COUNTS_PER_MS),
    rounds: AtomicU32::new(0),
    held: AtomicBool::new(false),
    coarse: AtomicBool::new(false),
    queue: Mutex::new(RefCell::new(Queue::new())),
});

/// Starts the clock at zero.
pub(super) fn start(mut systick: SYST) {
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(COUNTS_PER_MS - 1);
    systick.clear_current();
    systick.enable_counter();
    systick.enable_interrupt();
}

/// Makes the time that of the last whole millisecond: reading the counter costs QEMU as much as a thousand
/// instructions.
pub(super) fn coarse() {
    CLOCK.coarse.store(true, Ordering::Relaxed);
}

/// Runs a function with the clock stopped.
pub(super) fn held<T>(what: impl FnOnce() -> T) -> T {
    let counts = critical_section::with(|_| {
        CLOCK.held.store(true, Ordering::Relaxed);
        CLOCK.counts()
    });
    let done = what();
    critical_section::with(|_| {
        let mut from = left();
        // A wrap before does not count, nor does its interrupt.
        if SCB::is_pendst_pending() {
            SCB::clear_pendst();
            from = left();
        }
        CLOCK.begin(from + counts);
        CLOCK.held.store(false, Ordering::Relaxed);
    });
    done
}

/// Advances the clock to the next whole millisecond, if nothing is due before. Call with interrupts disabled.
pub(super) fn skip() {
    let left = left();
    let rounds = CLOCK.rounds.load(Ordering::Relaxed);
    if left > CLOCK.from.load(Ordering::Relaxed) + rounds * COUNTS_PER_MS {
        // The counter wrapped while interrupts were disabled; its interrupt would count it for the next millisecond.
        SCB::clear_pendst();
    }
    CLOCK.begin(left);
    CLOCK.tick();
}

/// Whole milliseconds since [`start`].
pub(super) fn milliseconds() -> u32 {
    CLOCK.ms.load(Ordering::Relaxed)
}

impl SysTickClock {
    /// The last whole millisecond, the time of alarms \[us\]. Avoids reading the counter, which is slow in QEMU.
    fn whole_us(&self) -> u64 {
        u64::from(self.ms.load(Ordering::Relaxed)) * 1000
    }

    /// Counts since the start of this millisecond.
    fn counts(&self) -> u32 {
        let before = left();
        // The counter has wrapped, and its interrupt is pending.
        let ended = SCB::is_pendst_pending();
        let left = if ended { left() } else { before };
        let rounds = self.rounds.load(Ordering::Relaxed) + u32::from(ended);
        (self.from.load(Ordering::Relaxed) + rounds * COUNTS_PER_MS).saturating_sub(left)
    }

    /// Starts a millisecond at this counter value.
    fn begin(&self, from: u32) {
        self.from.store(from, Ordering::Relaxed);
        self.rounds.store(0, Ordering::Relaxed);
    }

    /// Ends a millisecond: wakes the tasks that are due.
    fn tick(&self) {
        let ms = self.ms.fetch_add(1, Ordering::Relaxed) + 1;
        watchdog::check(ms);
        critical_section::with(|cs| self.queue.borrow(cs).borrow_mut().next_expiration(self.whole_us()));
    }
}

/// Remaining counts in this round: 1 to a whole millisecond. The interrupt comes at zero, which belongs to the next
/// round.
fn left() -> u32 {
    match SYST::get_current() {
        0 => COUNTS_PER_MS,
        left => left,
    }
}

impl Driver for SysTickClock {
    fn now(&self) -> u64 {
        if self.coarse.load(Ordering::Relaxed) {
            return self.whole_us();
        }
        let (ms, counts) = critical_section::with(|_| (self.ms.load(Ordering::Relaxed), self.counts()));
        // 32-bit division: the duration of the 64-bit one grows with the time.
        u64::from(ms) * 1000 + u64::from(counts / COUNTS_PER_US)
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        critical_section::with(|cs| {
            let mut queue = self.queue.borrow(cs).borrow_mut();
            if queue.schedule_wake(at, waker) {
                // The next interrupt checks the queue anyway; this wakes tasks that are already due.
                queue.next_expiration(self.whole_us());
            }
        });
    }
}

#[cortex_m_rt::exception]
fn SysTick() {
    if CLOCK.held.load(Ordering::Relaxed) {
        return;
    }
    CLOCK.rounds.fetch_add(1, Ordering::Relaxed);
    if CLOCK.counts() >= COUNTS_PER_MS {
        CLOCK.rounds.fetch_sub(1, Ordering::Relaxed);
        CLOCK.tick();
    }
}
