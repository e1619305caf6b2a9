//! Lets the watchdog bite when a task stands still. It runs at the lowest priority, so that an interrupt or a task that
//! never ends is caught as well.

use crate::heartbeat::{self, Task};
use crate::{board, crash};
use core::future::pending;
use embassy_time::{Duration, Ticker};
use link::report::FaultKind;

/// How long the watchdog waits for food before it resets the chip.
pub const WATCHDOG: Duration = Duration::from_millis(100);

/// Feeds the watchdog ten times in its patience, as long as each of `tasks` reports, counted from the start of this
/// task. After the first that does not it is never fed again.
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
