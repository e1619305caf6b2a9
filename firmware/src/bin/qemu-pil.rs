//! Image for processor in the loop (`sim-host pil`): all tasks; the host simulates bicycle, sensors and motor.
//!
//! Arguments: those of `board::fault_injection`.
#![no_std]
#![no_main]

use control::Config;
use firmware::board::semihosting::exit;
use firmware::board::{self, Exit, executor, fault_injection, pil, text};
use firmware::heartbeat::Task;
use firmware::tasks::settings::{self, StoredConfig};
use firmware::{crash, tasks};
use link::report::config_hash;
use static_cell::StaticCell;

#[cortex_m_rt::entry]
fn main() -> ! {
    static STORED: StaticCell<StoredConfig> = StaticCell::new();
    pil::begin();
    board::restarts();
    crash::start(board::reset_cause());
    text::line(format_args!("{}", firmware::identity!()));
    if !fault_injection::prepare() {
        text::line(format_args!("no such fault, or at_ms is missing"));
        exit(Exit::Input)
    }
    let stored = STORED.init(StoredConfig::open());
    let plan = settings::start(stored, &Config::product());
    text::line(format_args!(
        "configuration {:08x}, parameters: {}",
        config_hash(plan.config()),
        stored.found()
    ));
    board::run(
        |control| {
            control.spawn(tasks::control(plan).unwrap());
            executor::below_control().spawn(pil::exchange().unwrap());
            executor::above_control().spawn(fault_injection::strike().unwrap());
        },
        |thread| {
            thread.spawn(tasks::line(firmware::image!(), stored).unwrap());
            thread.spawn(tasks::report().unwrap());
            thread.spawn(tasks::supervise(&[Task::Control, Task::Line, Task::Report]).unwrap());
        },
    )
}
