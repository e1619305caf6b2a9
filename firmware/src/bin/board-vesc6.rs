//! Image for a VESC 6 (STM32F405) with all tasks. It gives no torque until the motor's encoder is aligned and the
//! polarity check is passed; log and telemetry have the reasons.
#![no_std]
#![no_main]

use control::Config;
use devices::vesc6::MOTOR;
use firmware::heartbeat::Task;
use firmware::tasks::settings::{self, StoredConfig};
use firmware::{board, crash, tasks};
use link::report::config_hash;
use static_cell::StaticCell;

#[cortex_m_rt::entry]
fn main() -> ! {
    static STORED: StaticCell<StoredConfig> = StaticCell::new();
    crash::start(board::reset_cause());
    defmt::info!(
        "{=str} start {=u32} after {=str}",
        firmware::identity!(),
        crash::starts(),
        crash::cause().name()
    );
    board::log_stored_fault();
    let motor = board::start();
    let stored = STORED.init(StoredConfig::open());
    let plan = settings::start(stored, &Config::product());
    defmt::info!(
        "configuration {=u32:08x}, parameters: {}",
        config_hash(plan.config()),
        defmt::Display2Format(stored.found())
    );
    let offset = stored.choose_offset(MOTOR.encoder.offset_turns, MOTOR.motor_id());
    defmt::info!("encoder offset: {}", defmt::Display2Format(&offset));
    motor.start(offset.turns());
    board::run(
        |control| control.spawn(defmt::unwrap!(tasks::control(plan).ok())),
        |thread| {
            thread.spawn(defmt::unwrap!(tasks::line(firmware::image!(), stored).ok()));
            thread.spawn(defmt::unwrap!(tasks::report().ok()));
            thread.spawn(defmt::unwrap!(board::broadcast().ok()));
            thread.spawn(defmt::unwrap!(board::record_drive_faults().ok()));
            thread.spawn(defmt::unwrap!(tasks::supervise(&[Task::Control, Task::Line, Task::Report]).ok()));
        },
    )
}
