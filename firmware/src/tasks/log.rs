//! A line of text for the engineer, from the lowest priority.

use super::latest;
use crate::board;
use crate::heartbeat::Task;
use embassy_time::{Duration, Ticker};

/// How often the task reports that it is alive, and how many of these make a second.
const BEAT: Duration = Duration::from_millis(20);
const BEATS: u32 = 50;

/// Says once a second what the control task did last.
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
