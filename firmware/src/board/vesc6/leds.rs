//! The board's two LEDs: green blinks with the control steps, red is on while no torque is possible.

use super::pins::Pin;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use embassy_stm32::gpio::Level;
use embassy_stm32::pac::GPIOB;

/// Pin numbers on port B.
const GREEN: usize = 0;
const RED: usize = 1;

/// Control steps between two changes of the green LED.
const BLINK: u32 = 500;

static STEPS: AtomicU32 = AtomicU32::new(0);

/// Switches both on.
pub(super) fn start(green: Pin, red: Pin) {
    [green, red].into_iter().for_each(|pin| super::pins::fixed(pin, Level::High));
}

/// Shows one control step, and whether torque is possible.
pub(super) fn show(able: bool) {
    let steps = STEPS.load(Relaxed).wrapping_add(1);
    STEPS.store(steps, Relaxed);
    GPIOB.bsrr().write(|w| {
        let dark = steps / BLINK % 2 == 1;
        w.set_bs(GREEN, !dark);
        w.set_br(GREEN, dark);
        w.set_bs(RED, !able);
        w.set_br(RED, able);
    });
}
