//! Four executors: three in interrupts of peripherals that the board does not use, and one in the thread.
//!
//! Interrupts are slow in QEMU, so one is requested only where it has to preempt something: otherwise the thread
//! polls the woken executors, the most urgent first, at the priority of their interrupt.
#![allow(unsafe_code)]

use super::time;
use crate::failure;
use core::ptr::null_mut;
use core::sync::atomic::{AtomicBool, AtomicPtr, Ordering};
use cortex_m::peripheral::scb::SystemHandler;
use cortex_m::peripheral::{NVIC, Peripherals};
use cortex_m::register::basepri;
use embassy_executor::raw::Executor;
use embassy_executor::{SendSpawner, Spawner};
use static_cell::StaticCell;
use stm32_metapac::{Interrupt, interrupt};

/// An executor and its interrupt.
struct Level {
    /// Null before the start.
    executor: AtomicPtr<Executor>,
    /// Whether a task of it was woken.
    woken: AtomicBool,
    /// `None` for the thread.
    interrupt: Option<Interrupt>,
    /// Priority of the interrupt; lower is more urgent.
    priority: u8,
}

const ABOVE_CONTROL: usize = 0;
const CONTROL: usize = 1;
const BELOW_CONTROL: usize = 2;
const THREAD: usize = 3;

/// Ordered by priority. The clock's interrupt is above all.
static LEVELS: [Level; 4] = [
    Level::new(Some(Interrupt::USART6), 0x20),
    Level::new(Some(Interrupt::UART5), 0x40),
    Level::new(Some(Interrupt::USART3), 0x60),
    Level::new(None, 0),
];

/// Whether the thread is about to poll the woken executors itself.
static IDLE: AtomicBool = AtomicBool::new(false);

impl Level {
    const fn new(interrupt: Option<Interrupt>, priority: u8) -> Self {
        let (executor, woken) = (AtomicPtr::new(null_mut()), AtomicBool::new(false));
        Self { executor, woken, interrupt, priority }
    }

    fn executor(&self) -> &'static Executor {
        // SAFETY: null, or the executor that `run` stored, which is never freed.
        unsafe { self.executor.load(Ordering::Relaxed).as_ref() }.expect("the board runs")
    }

    /// Polls the executor if it was woken.
    ///
    /// # Safety
    /// Call at the level's priority: the poll must not interrupt itself.
    unsafe fn poll(&self) {
        self.woken.store(false, Ordering::Relaxed);
        // SAFETY: guaranteed by the caller.
        unsafe { self.executor().poll() }
    }
}

/// Starts the clock and the executors: `control` gets the one at control's priority, `thread` the
/// lowest one.
///
/// # Panics
/// When called a second time.
pub fn run(control: impl FnOnce(SendSpawner), thread: impl FnOnce(Spawner)) -> ! {
    static EXECUTORS: StaticCell<[Executor; LEVELS.len()]> = StaticCell::new();
    let mut core = Peripherals::take().expect("the board is run once");
    failure::enable();
    let executors = EXECUTORS.init_with(|| core::array::from_fn(|level| Executor::new(level as *mut ())));
    for (level, executor) in LEVELS.iter().zip(executors) {
        level.executor.store(executor, Ordering::Relaxed);
        let Some(interrupt) = level.interrupt else { continue };
        // SAFETY: critical sections do not depend on priorities here, and the handlers find their executors.
        unsafe {
            core.NVIC.set_priority(interrupt, level.priority);
            NVIC::unmask(interrupt);
        }
    }
    // SAFETY: as above.
    unsafe { core.SCB.set_priority(SystemHandler::SysTick, 0x00) };
    time::start(core.SYST);
    thread(LEVELS[THREAD].executor().spawner());
    control(spawner(CONTROL));
    loop {
        poll_woken();
        cortex_m::interrupt::disable();
        // Every alarm is at a whole millisecond. `wfi` would end there too, but only after QEMU switched its threads,
        // which takes longer than a control step.
        if !LEVELS.iter().any(|level| level.woken.load(Ordering::Relaxed)) {
            IDLE.store(true, Ordering::Relaxed);
            time::skip();
            IDLE.store(false, Ordering::Relaxed);
        }
    }
}

/// Polls the woken executors, each at its priority, and leaves interrupts enabled.
fn poll_woken() {
    for level in LEVELS.iter().filter(|level| level.woken.load(Ordering::Relaxed)) {
        // SAFETY: raises the priority to that of the level, so that its own interrupt can't come, then
        // lowers it; outside every critical section.
        unsafe {
            basepri::write(level.priority);
            cortex_m::interrupt::enable();
            level.poll();
            basepri::write(0);
        }
    }
    // SAFETY: outside every critical section.
    unsafe { cortex_m::interrupt::enable() };
}

/// Starts an executor above control: for tests that delay control.
pub fn above_control() -> SendSpawner {
    spawner(ABOVE_CONTROL)
}

/// Starts an executor between control and the thread: for tasks that replace hardware.
pub fn below_control() -> SendSpawner {
    spawner(BELOW_CONTROL)
}

fn spawner(level: usize) -> SendSpawner {
    LEVELS[level].executor().spawner().make_send()
}

/// Called by an executor from any context when one of its tasks is woken.
#[unsafe(export_name = "__pender")]
fn wake(level: *mut ()) {
    let level = &LEVELS[level as usize];
    level.woken.store(true, Ordering::Relaxed);
    if let (false, Some(interrupt)) = (IDLE.load(Ordering::Relaxed), level.interrupt) {
        NVIC::pend(interrupt);
    }
}

#[interrupt]
fn USART3() {
    // SAFETY: this is the level's interrupt.
    unsafe { LEVELS[BELOW_CONTROL].poll() }
}

#[interrupt]
fn UART5() {
    // SAFETY: as above.
    unsafe { LEVELS[CONTROL].poll() }
}

#[interrupt]
fn USART6() {
    // SAFETY: as above.
    unsafe { LEVELS[ABOVE_CONTROL].poll() }
}
