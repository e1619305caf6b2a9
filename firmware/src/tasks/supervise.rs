//! Lets the watchdog bite when control stands still. It runs at the lowest priority, so that an
//! interrupt or a task that never ends is caught as well.

use super::latest;
use crate::board;
use embassy_time::{Duration, Ticker};

/// How long the watchdog waits for food before it resets the chip.
pub const WATCHDOG: Duration = Duration::from_millis(100);

/// Feeds the watchdog ten times in its patience, each time only if a step was done since the last.
#[embassy_executor::task]
pub async fn supervise() {
    let mut check = Ticker::every(WATCHDOG / 10);
    let mut seen = 0;
    loop {
        check.next().await;
        let steps = latest().map_or(0, |telemetry| telemetry.deadlines.steps);
        if steps != seen {
            board::feed_watchdog();
        }
        seen = steps;
    }
}
