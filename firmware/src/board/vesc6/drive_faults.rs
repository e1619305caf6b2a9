//! Finds, logs and stores the reason for which the bridge was opened until the next start; at the lowest priority.

use super::{gate, motor_report, outputs_off};
use crate::crash::{self, Registers};
use core::fmt::Write;
use embassy_time::{Duration, Timer};
use heapless::String;
use link::report::{FAULT_TEXT_BYTES, FaultKind};

/// Polling period.
const POLL_PERIOD: Duration = Duration::from_millis(10);

/// Stores a gate-driver fault with the driver's status, and the first faults of the motor loop.
#[embassy_executor::task]
pub async fn record_drive_faults() {
    // A driver whose start failed is in the log of the start.
    let (mut gate, mut motor) = (!gate::is_started(), false);
    loop {
        Timer::after(POLL_PERIOD).await;
        let report = motor_report();
        let mut text = String::<FAULT_TEXT_BYTES>::new();
        // Longer text is cut.
        if report.gate_fault && !gate {
            gate = true;
            let _ = write!(text, "gate driver: ").and_then(|()| gate::describe(&mut text));
            outputs_off();
            store(&text);
        } else if !report.faults.is_empty() && !motor {
            motor = true;
            let _ = write!(text, "motor fault");
            report.faults.iter().for_each(|fault| _ = write!(text, " {}", fault.code()));
            store(&text);
        }
    }
}

fn store(text: &str) {
    defmt::error!("{=str}", text);
    crash::note(FaultKind::Drive, Registers::default(), text);
}
