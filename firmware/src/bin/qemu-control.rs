//! Image that runs the shared tasks for some simulated seconds with a fully loaded thread executor. Succeeds only if
//! every period had its step and no step was late.
//!
//! Arguments: `seconds=5`; `block_us=N` blocks control for N us once every `every_ms=100` milliseconds, from a higher
//! priority, beginning at a release; `start_ms=N`: the tasks start N ms after the clock, as on a board with slowly
//! starting parts.
#![no_std]
#![no_main]

use control::{Config, Plan};
use cortex_m_semihosting::hprintln;
use embassy_time::{Duration, Instant, Timer};
use firmware::board::semihosting::{argument, exit};
use firmware::board::{self, Exit, executor};
use firmware::heartbeat::Task;
use firmware::{tasks, telemetry};
use link::report::config_hash;
use static_cell::StaticCell;

/// Loads the thread executor; yields to its other tasks every 0.3 ms.
#[embassy_executor::task]
async fn hog() {
    loop {
        spin_until(Instant::now() + Duration::from_micros(300));
        embassy_futures::yield_now().await;
    }
}

/// Blocks control for `hold` from one release in every `every`, the first in the middle of it.
#[embassy_executor::task]
async fn block(every: Duration, hold: Duration) {
    let mut release = Instant::from_ticks(0) + every / 2;
    loop {
        Timer::at(release).await;
        spin_until(release + hold);
        release += every;
    }
}

/// Ends the run and reports the result.
#[embassy_executor::task]
async fn end_run(length: Duration) {
    let start = Instant::from_millis(Instant::now().as_millis());
    Timer::at(start + length).await;
    let Some(t) = telemetry::latest() else { exit(Exit::Failure) };
    let expected = (length.as_micros() / firmware::deadline::PERIOD.as_micros()) as u32;
    let missed = t.deadlines.missed(length);
    let (steps, worst_us, mode) = (t.deadlines.steps, t.deadlines.worst_us, t.command.mode.name());
    hprintln!("done: steps={} missed={} worst_us={} mode={}", steps, missed, worst_us, mode);
    exit(if t.deadlines.steps == expected && missed == 0 { Exit::Success } else { Exit::Failure })
}

/// Start of a board with slowly starting parts; the watchdog's timeout is extended meanwhile.
fn start_slowly(length: Duration) {
    let end = Instant::now() + length;
    while Instant::now() < end {
        board::feed_watchdog();
    }
}

fn spin_until(end: Instant) {
    while Instant::now() < end {}
}

#[cortex_m_rt::entry]
fn main() -> ! {
    static PLAN: StaticCell<Plan> = StaticCell::new();
    hprintln!("{}", firmware::identity!());
    let mut config = Config::product();
    // The simulated sensors match the configured calibration.
    config.calibration.polarity_checked = true;
    let Ok(plan) = config.plan() else { exit(Exit::Input) };
    let plan = PLAN.init(plan);
    hprintln!("configuration {:08x}", config_hash(plan.config()));
    let length = Duration::from_secs(argument("seconds").unwrap_or(5).into());
    let every = Duration::from_millis(argument("every_ms").unwrap_or(100).into());
    let start = Duration::from_millis(argument("start_ms").unwrap_or(0).into());
    let hold = argument("block_us").map(|us| Duration::from_micros(us.into()));
    board::run(
        |control| {
            control.spawn(tasks::control(plan).unwrap());
            if let Some(hold) = hold {
                executor::above_control().spawn(block(every, hold).unwrap());
            }
        },
        |thread| {
            start_slowly(start);
            thread.spawn(tasks::supervise(&[Task::Control, Task::Report]).unwrap());
            thread.spawn(tasks::report().unwrap());
            thread.spawn(hog().unwrap());
            thread.spawn(end_run(length).unwrap());
        },
    )
}
