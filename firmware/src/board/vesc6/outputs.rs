//! Switches the outputs off.

use super::{pins, pwm, shared};
use embassy_stm32::pac::GPIOB;

/// Opens all six switches and disables the gate driver until the next start. Can be called from any context, fault
/// handlers included: it writes three words at fixed addresses.
pub fn outputs_off() {
    // First, so that the motor interrupt does not close the bridge again.
    shared::set_off();
    pwm::open();
    GPIOB.bsrr().write(|w| w.set_br(pins::GATE_ENABLE, true));
}
