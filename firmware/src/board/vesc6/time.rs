//! Embassy's time driver on TIM5: 32 bits, 1 us per count.
//!
//! While flash is erased the chip and its interrupts halt for half a second per sector. The HAL's driver uses a 16-bit
//! counter with two interrupts per round of 65.5 ms, and loses those that occur meanwhile (embassy-stm32 0.6.0,
//! `time_driver/gp16.rs`). This driver needs two in 71 minutes.

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

/// Prescaler: the timer's clock over 1 MHz, less one.
const TO_1_MHZ: u16 = 84 - 1;
/// Compare channels: half of the range, and the next alarm.
const HALF: usize = 0;
const ALARM: usize = 1;

/// State of the clock.
struct Clock {
    /// Number of half ranges counted by the interrupt.
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
    // The update that loads the prescaler is not an overflow.
    TIM5.cr1().modify(|w| w.set_urs(Urs::COUNTER_ONLY));
    TIM5.egr().write(|w| w.set_ug(true));
    TIM5.dier().write(|w| {
        w.set_uie(true);
        w.set_ccie(HALF, true);
        w.set_ccie(ALARM, true);
    });
    // SAFETY: critical sections mask its priority.
    unsafe { interrupt::TIM5.enable() }
    TIM5.cr1().modify(|w| w.set_cen(true));
}

impl Clock {
    /// Wakes the tasks that are due and sets the next alarm.
    fn wake_due(&self, queue: &mut Queue) {
        loop {
            let next = queue.next_expiration(self.now());
            // An alarm of a later round occurs early, and is then set again.
            TIM5.ccr(ALARM).write_value(next as u32);
            // The channel has no event for a time that passed meanwhile.
            if next > self.now() {
                return;
            }
        }
    }

    fn interrupt(&self, cs: CriticalSection<'_>) {
        let flags = TIM5.sr().read();
        // Writing zero clears a flag; a flag set meanwhile stays.
        TIM5.sr().write_value(SrGp16(!flags.0));
        let ended = u32::from(flags.uif()) + u32::from(flags.ccif(HALF));
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
