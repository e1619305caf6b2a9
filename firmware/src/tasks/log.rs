//! Periodic log line, from the lowest priority.

use crate::board;
use crate::heartbeat::Task;
use crate::telemetry::latest;
use embassy_time::{Duration, Ticker};

/// Heartbeat period, and number of heartbeats per log line.
const BEAT: Duration = Duration::from_millis(20);
const BEATS: u32 = 50;

/// Logs the last control step once per second.
#[embassy_executor::task]
pub async fn report() {
    let mut beat = Ticker::every(BEAT);
    loop {
        for _ in 0..BEATS {
            beat.next().await;
            Task::Report.report();
        }
        if let Some(telemetry) = latest() {
            board::report(&telemetry);
        }
    }
}
