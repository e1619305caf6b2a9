//! The image for a board with an STM32F405 (VESC-6 class). It gives no torque: the reason is in its
//! telemetry.
#![no_std]
#![no_main]

use control::{Config, Plan};
use firmware::{board, tasks};
use static_cell::StaticCell;

#[cortex_m_rt::entry]
fn main() -> ! {
    static PLAN: StaticCell<Plan> = StaticCell::new();
    defmt::info!("{=str}", firmware::identity!());
    let plan: &'static Plan = PLAN.init(defmt::unwrap!(Config::product().plan().ok()));
    board::run(
        |control| control.spawn(defmt::unwrap!(tasks::control(plan).ok())),
        |thread| {
            thread.spawn(defmt::unwrap!(tasks::supervise().ok()));
            thread.spawn(defmt::unwrap!(tasks::report().ok()));
        },
    )
}
