//! Controller, motor's loop and simulated motor together on the bicycle.

#[path = "../../../firmware/motor/tests/cards/machine.rs"]
#[allow(dead_code, reason = "shared with the motor's own cards")]
mod machine;

mod axle;
mod slip;
