//! Telemetry for the engineer, from the lowest priority.

use super::latest;
use crate::board;
use embassy_time::{Duration, Ticker};

/// Says once a second what the control task did last.
#[embassy_executor::task]
pub async fn report() {
    let mut second = Ticker::every(Duration::from_secs(1));
    loop {
        second.next().await;
        if let Some(telemetry) = latest() {
            board::report(&telemetry);
        }
    }
}
