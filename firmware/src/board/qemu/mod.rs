//! Board of the STM32F405 in QEMU's machine `netduinoplus2`: core, SysTick, NVIC, memories. QEMU does not model RCC
//! and PWR, so the chip's HAL does not start there; this thin layer does.

pub mod executor;
mod exit;
pub mod fault_injection;
mod flash;
pub mod functions;
pub mod pil;
pub mod recording;
mod reset;
pub mod semihosting;
mod sensors;
pub mod serial;
pub mod simulated_motor;
pub mod stack;
pub mod text;
pub mod time;
mod watchdog;

pub use executor::run;
pub use exit::end;
pub use fault_injection::heartbeat_lost;
pub use flash::{Flash, flash};
pub use reset::{outputs_off, reset_cause, restarts};
pub use semihosting::Exit;
pub use sensors::{drive, sense};
pub use watchdog::{StoreGuard, feed_watchdog};

use crate::telemetry::Telemetry;

/// Writes one log line; the torque in mN m, since formatting an f32 takes 20 KB of flash.
pub fn report(t: &Telemetry) {
    text::line(format_args!(
        "steps={} late={} worst_us={} torque_mn_m={} mode={} drive={:?}",
        t.deadlines.steps,
        t.deadlines.late,
        t.deadlines.worst_us,
        (t.command.torque_nm * 1e3) as i32,
        t.command.mode.name(),
        t.drive
    ));
}
