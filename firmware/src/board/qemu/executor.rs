//! Four executors: three that interrupt, by interrupts of peripherals that the board does not use, and the thread's.
//!
//! Interrupts are dear in QEMU. So one is asked for only where something is to be interrupted: while nothing runs, the
//! thread itself polls what was woken, the urgent first, with the priority that its interrupt would have.
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

/// An executor and the interrupt that polls it.
struct Level {
    /// Null before the start.
    executor: AtomicPtr<Executor>,
    /// Something of it waits to be polled.
    woken: AtomicBool,
    /// `None`: the thread's.
    interrupt: Option<Interrupt>,
    /// Of the interrupt; lower is more urgent.
    priority: u8,
}

const ABOVE_CONTROL: usize = 0;
const CONTROL: usize = 1;
const BELOW_CONTROL: usize = 2;
const THREAD: usize = 3;

/// By their priority. The clock's interrupt is above all.
static LEVELS: [Level; 4] = [
    Level::new(Some(Interrupt::USART6), 0x20),
    Level::new(Some(Interrupt::UART5), 0x40),
    Level::new(Some(Interrupt::USART3), 0x60),
    Level::new(None, 0),
];

/// The thread polls whatever is woken next by itself.
static IDLE: AtomicBool = AtomicBool::new(false);

impl Level {
    const fn new(interrupt: Option<Interrupt>, priority: u8) -> Self {
        let (executor, woken) = (AtomicPtr::new(null_mut()), AtomicBool::new(false));
        Self { executor, woken, interrupt, priority }
    }

    fn executor(&self) -> &'static Executor {
        // SAFETY: null, or what `run` put there for ever.
        unsafe { self.executor.load(Ordering::Relaxed).as_ref() }.expect("the board runs")
    }

    /// Polls what was woken.
    ///
    /// # Safety
    /// To be called with the level's priority: it must not interrupt itself.
    unsafe fn poll(&self) {
        self.woken.store(false, Ordering::Relaxed);
        // SAFETY: as the caller says.
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
        // SAFETY: no critical section is built on priorities here, and the handlers find their executors.
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
        // Every alarm rings at a whole millisecond. `wfi` would end there too, after QEMU handed the clock from one of
        // its threads to another, which takes longer than a control step.
        if !LEVELS.iter().any(|level| level.woken.load(Ordering::Relaxed)) {
            IDLE.store(true, Ordering::Relaxed);
            time::skip();
            IDLE.store(false, Ordering::Relaxed);
        }
    }
}

/// Polls the executors that were woken, each with its priority, and leaves interrupts enabled.
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

/// Starts an executor whose tasks interrupt control: for tests that hold it up.
pub fn above_control() -> SendSpawner {
    spawner(ABOVE_CONTROL)
}

/// Starts an executor whose tasks control interrupts and the thread does not: for what is hardware elsewhere.
pub fn below_control() -> SendSpawner {
    spawner(BELOW_CONTROL)
}

fn spawner(level: usize) -> SendSpawner {
    LEVELS[level].executor().spawner().make_send()
}

/// What an executor calls, from anywhere, when one of its tasks is woken.
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
