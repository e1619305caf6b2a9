//! Embassy's clock on SysTick: an interrupt every millisecond, 168 counts of the 168 MHz processor
//! clock to the microsecond in between. Alarms ring at whole milliseconds.
#![allow(unsafe_code)]

use super::watchdog;
use core::cell::RefCell;
use core::sync::atomic::{AtomicU32, Ordering};
use core::task::Waker;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{SCB, SYST};
use critical_section::Mutex;
use embassy_time_driver::Driver;
use embassy_time_queue_utils::Queue;

const COUNTS_PER_US: u32 = 168;
const COUNTS_PER_MS: u32 = 1000 * COUNTS_PER_US;

struct SysTickClock {
    ms: AtomicU32,
    queue: Mutex<RefCell<Queue>>,
}

embassy_time_driver::time_driver_impl!(static CLOCK: SysTickClock = SysTickClock {
    ms: AtomicU32::new(0),
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

/// Lets the clock stand still, or go on where it stood.
pub(super) fn hold(still: bool) {
    // SAFETY: one bit of the clock's own register, which nothing else writes after its start.
    unsafe {
        (*SYST::PTR).csr.modify(|bits| if still { bits & !1 } else { bits | 1 });
    }
}

/// Nothing is to be done before the next whole millisecond: it is now. To be called with interrupts off.
pub(super) fn skip() {
    if SCB::is_pendst_pending() {
        return;
    }
    // SAFETY: the clock's own register, which nothing else writes after its start; any value sets it to zero, without
    // an interrupt, from where it counts a whole millisecond.
    unsafe {
        (*SYST::PTR).cvr.write(0);
    }
    SCB::set_pendst();
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
}

impl Driver for SysTickClock {
    fn now(&self) -> u64 {
        let (ms, counts) = critical_section::with(|_| {
            let ms = self.ms.load(Ordering::Relaxed);
            let left = SYST::get_current();
            // Wrapped, and its interrupt still waits.
            let (ms, left) =
                if SCB::is_pendst_pending() { (ms + 1, SYST::get_current()) } else { (ms, left) };
            // The interrupt comes with the count of zero: that belongs to the new millisecond.
            (ms, if left == 0 { 0 } else { COUNTS_PER_MS - left })
        });
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
    let ms = CLOCK.ms.load(Ordering::Relaxed) + 1;
    CLOCK.ms.store(ms, Ordering::Relaxed);
    watchdog::check(ms);
    critical_section::with(|cs| CLOCK.queue.borrow(cs).borrow_mut().next_expiration(CLOCK.whole_us()));
}
