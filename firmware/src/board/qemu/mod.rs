//! The STM32F405 as QEMU's machine `netduinoplus2` has it: core, SysTick, NVIC, memories. Its RCC
//! and PWR are not modelled, so the chip's HAL does not start there; this thin layer does.

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
pub use flash::{Flash, flash};
pub use reset::{outputs_off, reset_cause, restarts};
pub use sensors::{drive, sense};
pub use watchdog::feed_watchdog;

use crate::tasks::Telemetry;

/// How an image ends: the exit status of QEMU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Exit {
    /// All that the image checks holds.
    Success = 0,
    /// Something that the image checks does not hold.
    Failure = 1,
    /// The image's input is not what it must be.
    Input = 2,
    /// A panic.
    Panic = 101,
    /// A processor fault.
    Fault = 102,
    /// An interrupt that nobody asked for.
    StrayInterrupt = 103,
    /// The watchdog was not fed.
    Watchdog = 104,
}

/// One line of text; the torque in mN m, since printing an f32 takes 20 KB of flash.
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
