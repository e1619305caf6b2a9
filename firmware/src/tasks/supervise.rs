//! Supervisor: lets the watchdog reset the chip when a task stops. Runs at the lowest priority, so that an endless
//! interrupt or task is detected too.

use crate::heartbeat::{self, Task};
use crate::{board, crash};
use core::future::pending;
use embassy_time::{Duration, Ticker};
use link::report::FaultKind;

/// Timeout of the watchdog.
pub const WATCHDOG: Duration = Duration::from_millis(100);

/// Feeds the watchdog ten times per timeout while each of `tasks` reports, counted from the start of this task. After
/// the first missing report the watchdog is never fed again.
#[embassy_executor::task]
pub async fn supervise(tasks: &'static [Task]) {
    heartbeat::begin();
    let mut check = Ticker::every(WATCHDOG / 10);
    loop {
        check.next().await;
        if let Some(task) = heartbeat::silent(tasks) {
            crash::note(FaultKind::Watchdog, crash::Registers::default(), task.name());
            pending::<()>().await;
        }
        board::feed_watchdog();
    }
}
