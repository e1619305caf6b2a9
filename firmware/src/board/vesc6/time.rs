//! Embassy's clock on TIM5: 32 bits, 1 us to a count.
//!
//! While flash is erased the chip stands still, its interrupts included, for half a second a sector. The HAL's driver
//! counts 16 bits by two interrupts a round of 65.5 ms, and loses those that come meanwhile (embassy-stm32 0.6.0,
//! `time_driver/gp16.rs`). This one needs two in 71 minutes.

use core::cell::RefCell;
use core::sync::atomic::{AtomicU32, Ordering};
use core::task::Waker;
use critical_section::{CriticalSection, Mutex};
use devices::ticks::ticks;
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::InterruptExt;
use embassy_stm32::pac::TIM5;
use embassy_stm32::pac::timer::regs::SrGp16;
use embassy_stm32::pac::timer::vals::Urs;
use embassy_stm32::{peripherals, rcc};
use embassy_time_driver::Driver;
use embassy_time_queue_utils::Queue;

/// The timer's clock over 1 MHz, less one.
const TO_1_MHZ: u16 = 84 - 1;
/// Compare channels: half of the round, and the next alarm.
const HALF: usize = 0;
const ALARM: usize = 1;

/// Where the clock stands.
struct Clock {
    /// Halves of the counter's round that its interrupt has seen.
    halves: AtomicU32,
    queue: Mutex<RefCell<Queue>>,
}

embassy_time_driver::time_driver_impl!(static CLOCK: Clock = Clock {
    halves: AtomicU32::new(0),
    queue: Mutex::new(RefCell::new(Queue::new())),
});

/// Starts the clock at zero.
pub(super) fn start() {
    rcc::enable_and_reset::<peripherals::TIM5>();
    TIM5.psc().write_value(TO_1_MHZ);
    TIM5.arr().write_value(u32::MAX);
    TIM5.ccr(HALF).write_value(1 << 31);
    // The update that takes over the prescaler is not the end of a round.
    TIM5.cr1().modify(|w| w.set_urs(Urs::COUNTER_ONLY));
    TIM5.egr().write(|w| w.set_ug(true));
    TIM5.dier().write(|w| {
        w.set_uie(true);
        w.set_ccie(HALF, true);
        w.set_ccie(ALARM, true);
    });
    // SAFETY: its priority is one that critical sections stop.
    unsafe { interrupt::TIM5.enable() }
    TIM5.cr1().modify(|w| w.set_cen(true));
}

impl Clock {
    /// Wakes what is due and sets the alarm for what is next.
    fn wake_due(&self, queue: &mut Queue) {
        loop {
            let next = queue.next_expiration(self.now());
            // One of a later round rings early, and is set anew then.
            TIM5.ccr(ALARM).write_value(next as u32);
            // The channel does not ring for what passed meanwhile.
            if next > self.now() {
                return;
            }
        }
    }

    fn interrupt(&self, cs: CriticalSection<'_>) {
        let seen = TIM5.sr().read();
        // A flag goes where a zero is written; one that came since stays.
        TIM5.sr().write_value(SrGp16(!seen.0));
        let ended = u32::from(seen.uif()) + u32::from(seen.ccif(HALF));
        self.halves.store(self.halves.load(Ordering::Relaxed).wrapping_add(ended), Ordering::Relaxed);
        self.wake_due(&mut self.queue.borrow_ref_mut(cs));
    }
}

impl Driver for Clock {
    fn now(&self) -> u64 {
        let halves = self.halves.load(Ordering::Acquire);
        ticks(halves, TIM5.cnt().read())
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        critical_section::with(|cs| {
            let mut queue = self.queue.borrow_ref_mut(cs);
            if queue.schedule_wake(at, waker) {
                self.wake_due(&mut queue);
            }
        });
    }
}

#[interrupt]
fn TIM5() {
    critical_section::with(|cs| CLOCK.interrupt(cs));
}
