//! An STM32F405RG on a VESC-6 class motor drive: 8 MHz crystal, SWD. Its sensors and motor have no
//! drivers yet, so every torque is refused.
#![allow(unsafe_code)]

mod clock;
mod watchdog;

pub use watchdog::feed_watchdog;

use crate::tasks::{Refusal, Telemetry};
use control::{Command, SensorFrame};
use defmt_rtt as _;
use embassy_executor::{Executor, InterruptExecutor, SendSpawner, Spawner};
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use panic_probe as _;
use static_cell::StaticCell;

static CONTROL: InterruptExecutor = InterruptExecutor::new();

/// Starts clocks, watchdog and executors: `control` gets the one above everything but the clock's
/// interrupt, `thread` the lowest one.
///
/// # Panics
/// When called a second time.
pub fn run(control: impl FnOnce(SendSpawner), thread: impl FnOnce(Spawner)) -> ! {
    static THREAD: StaticCell<Executor> = StaticCell::new();
    let peripherals = embassy_stm32::init(clock::config());
    watchdog::start(peripherals.IWDG);
    // The board does not use UART5: its interrupt is the control executor's.
    interrupt::UART5.set_priority(Priority::P4);
    THREAD.init(Executor::new()).run(|spawner| {
        thread(spawner);
        control(CONTROL.start(interrupt::UART5));
    })
}

#[interrupt]
fn UART5() {
    // SAFETY: the handler of the interrupt that CONTROL was started with.
    unsafe { CONTROL.on_interrupt() }
}

/// The sensors of this instant: none.
pub fn sense() -> SensorFrame {
    SensorFrame::missing()
}

/// Gives the command to the motor.
///
/// # Errors
/// Always: there is no driver for it.
pub fn drive(_: &Command) -> Result<(), Refusal> {
    Err(Refusal::NoSensorAndMotorDrivers)
}

/// One line of defmt over RTT.
pub fn report(t: &Telemetry) {
    defmt::info!(
        "steps={=u32} late={=u32} worst_us={=u32} torque_nm={=f32} mode={=str} motor={=str}",
        t.deadlines.steps,
        t.deadlines.late,
        t.deadlines.worst_us,
        t.command.torque_nm,
        t.command.mode.name(),
        t.drive.map_or_else(Refusal::reason, |()| "driven")
    );
}
