//! Four executors: three in interrupts of peripherals that the board does not use, one in the thread.
#![allow(unsafe_code)]

use super::time;
use crate::failure;
use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::scb::SystemHandler;
use cortex_m::peripheral::{NVIC, Peripherals};
use embassy_executor::{InterruptExecutor, SendSpawner, Spawner, raw};
use static_cell::StaticCell;
use stm32_metapac::{Interrupt, interrupt};

static CONTROL: InterruptExecutor = InterruptExecutor::new();
static BELOW_CONTROL: InterruptExecutor = InterruptExecutor::new();
static ABOVE_CONTROL: InterruptExecutor = InterruptExecutor::new();

/// Starts the clock and the executors: `control` gets the one at control's priority, `thread` the
/// lowest one.
///
/// # Panics
/// When called a second time.
pub fn run(control: impl FnOnce(SendSpawner), thread: impl FnOnce(Spawner)) -> ! {
    static THREAD: StaticCell<raw::Executor> = StaticCell::new();
    let mut core = Peripherals::take().expect("the board is run once");
    failure::enable();
    // SAFETY: no critical section is built on priorities here, and no handler runs yet.
    unsafe {
        core.SCB.set_priority(SystemHandler::SysTick, 0x00);
        core.NVIC.set_priority(Interrupt::USART6, 0x20);
        core.NVIC.set_priority(Interrupt::UART5, 0x40);
        core.NVIC.set_priority(Interrupt::USART3, 0x60);
    }
    time::start(core.SYST);

    // UART4 stays disabled: its pending bit is how tasks wake the thread's executor.
    let wake = Interrupt::UART4;
    let executor = THREAD.init(raw::Executor::new(wake.number() as usize as *mut ()));
    thread(executor.spawner());
    control(CONTROL.start(Interrupt::UART5));
    loop {
        NVIC::unpend(wake);
        // SAFETY: only this loop polls it, and never from within itself.
        unsafe { executor.poll() };
        // Every alarm rings at a whole millisecond. `wfi` would end there too, after QEMU handed the clock from one of
        // its threads to another, which takes longer than a control step.
        cortex_m::interrupt::disable();
        if !NVIC::is_pending(wake) {
            time::skip();
        }
        // SAFETY: outside every critical section.
        unsafe { cortex_m::interrupt::enable() };
    }
}

/// Starts an executor whose tasks interrupt control: for tests that hold it up.
pub fn above_control() -> SendSpawner {
    ABOVE_CONTROL.start(Interrupt::USART6)
}

/// Starts an executor whose tasks control interrupts and the thread does not: for what is hardware elsewhere.
pub fn below_control() -> SendSpawner {
    BELOW_CONTROL.start(Interrupt::USART3)
}

#[interrupt]
fn USART3() {
    // SAFETY: the handler of the interrupt that BELOW_CONTROL was started with.
    unsafe { BELOW_CONTROL.on_interrupt() }
}

#[interrupt]
fn UART5() {
    // SAFETY: the handler of the interrupt that CONTROL was started with.
    unsafe { CONTROL.on_interrupt() }
}

#[interrupt]
fn USART6() {
    // SAFETY: the handler of the interrupt that ABOVE_CONTROL was started with.
    unsafe { ABOVE_CONTROL.on_interrupt() }
}
