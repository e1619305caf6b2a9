//! Embassy's clock on SysTick: 168 counts of the 168 MHz processor clock to the microsecond. Alarms ring at whole
//! milliseconds.
//!
//! The counter runs round once a millisecond of instructions and is never written after its start: QEMU would wake
//! another of its threads each time, which takes longer than a control step. A millisecond that is left out, or a
//! time in which the clock is held, is reckoned instead, by where the counter stood.
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

/// Where the clock stands. Touched with interrupts off only, by everybody but the clock's interrupt.
struct SysTickClock {
    ms: AtomicU32,
    /// Counter at the start of this millisecond.
    from: AtomicU32,
    /// Rounds of the counter since.
    rounds: AtomicU32,
    /// The clock stands still.
    held: AtomicBool,
    /// Nobody looks between whole milliseconds.
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

/// From now on the time is that of the last whole millisecond: each look at the counter costs QEMU as much as a
/// thousand instructions.
pub(super) fn coarse() {
    CLOCK.coarse.store(true, Ordering::Relaxed);
}

/// Does something that takes no time by this clock.
pub(super) fn held<T>(what: impl FnOnce() -> T) -> T {
    let counts = critical_section::with(|_| {
        CLOCK.held.store(true, Ordering::Relaxed);
        CLOCK.counts()
    });
    let done = what();
    critical_section::with(|_| {
        let mut from = left();
        // A round that ended before does not count, its interrupt neither.
        if SCB::is_pendst_pending() {
            SCB::clear_pendst();
            from = left();
        }
        CLOCK.begin(from + counts);
        CLOCK.held.store(false, Ordering::Relaxed);
    });
    done
}

/// Nothing is to be done before the next whole millisecond: it is now. To be called with interrupts off.
pub(super) fn skip() {
    let left = left();
    let rounds = CLOCK.rounds.load(Ordering::Relaxed);
    if left > CLOCK.from.load(Ordering::Relaxed) + rounds * COUNTS_PER_MS {
        // The round ended since interrupts are off; its own would count it for the next millisecond.
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
    /// The last whole millisecond, when alarms ring \[us\]. QEMU takes its time for a look at the counter.
    fn whole_us(&self) -> u64 {
        u64::from(self.ms.load(Ordering::Relaxed)) * 1000
    }

    /// Counts since the start of this millisecond.
    fn counts(&self) -> u32 {
        let before = left();
        // The round has ended, perhaps just now, and its interrupt still waits.
        let ended = SCB::is_pendst_pending();
        let left = if ended { left() } else { before };
        let rounds = self.rounds.load(Ordering::Relaxed) + u32::from(ended);
        (self.from.load(Ordering::Relaxed) + rounds * COUNTS_PER_MS).saturating_sub(left)
    }

    /// A millisecond begins with this counter.
    fn begin(&self, from: u32) {
        self.from.store(from, Ordering::Relaxed);
        self.rounds.store(0, Ordering::Relaxed);
    }

    /// A millisecond is over: what is due then is woken.
    fn tick(&self) {
        let ms = self.ms.fetch_add(1, Ordering::Relaxed) + 1;
        watchdog::check(ms);
        critical_section::with(|cs| self.queue.borrow(cs).borrow_mut().next_expiration(self.whole_us()));
    }
}

/// What the counter still has to count in this round: 1 to a whole millisecond. Its interrupt comes with zero, which
/// belongs to the next round.
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
        // 32-bit division: the 64-bit one takes longer the longer the clock runs.
        u64::from(ms) * 1000 + u64::from(counts / COUNTS_PER_US)
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        critical_section::with(|cs| {
            let mut queue = self.queue.borrow(cs).borrow_mut();
            if queue.schedule_wake(at, waker) {
                // The next interrupt looks at the queue anyway; this wakes what is already due.
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
