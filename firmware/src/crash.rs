//! Reaction to fatal failures: switches the outputs off, stores a fault record, restarts.

use crate::{board, retained, telemetry};
use core::sync::atomic::{AtomicU32, Ordering};
use link::fault_log::{self, LastStep};
use link::report::{FaultKind, FaultRecord, ResetCause};

/// Number of starts, and the cause of this one.
static START: AtomicU32 = AtomicU32::new(0);
static CAUSE: AtomicU32 = AtomicU32::new(0);

/// Details of a processor exception; 0 for other faults.
#[derive(Clone, Copy, Debug, Default)]
pub struct Registers {
    /// Exception number.
    pub exception: u32,
    /// CFSR, HFSR, BFAR, SP, PC, LR.
    pub values: [u32; 6],
}

/// Call first in `main`, with the cause of this start. Records a watchdog reset that the supervisor had not recorded
/// before.
pub fn start(cause: ResetCause) {
    let starts = retained::start();
    START.store(starts, Ordering::Relaxed);
    CAUSE.store(cause as u32, Ordering::Relaxed);
    let recorded = retained::with(|ring| {
        let newest = fault_log::faults(ring).next();
        newest.is_some_and(|f| f.kind == FaultKind::Watchdog && f.boot.wrapping_add(1) == starts)
    });
    if cause == ResetCause::Watchdog && recorded == Some(false) {
        let last = retained::with(|ring| fault_log::last_step(ring)).flatten().unwrap_or_default();
        keep(FaultKind::Watchdog, &last, Registers::default(), "the lowest priority stood still");
    }
}

/// Number of starts.
pub fn starts() -> u32 {
    START.load(Ordering::Relaxed)
}

/// Cause of this start.
pub fn cause() -> ResetCause {
    ResetCause::numbered(CAUSE.load(Ordering::Relaxed) as u8).unwrap_or_default()
}

/// Stores a fault with the state of the last control step. Can be called from any context.
pub fn note(kind: FaultKind, registers: Registers, text: &str) {
    keep(kind, &telemetry::latest().map_or_else(LastStep::default, |t| t.last_step()), registers, text);
}

fn keep(kind: FaultKind, last: &LastStep, registers: Registers, text: &str) {
    let LastStep { steps, frame_us, causes, mode } = *last;
    let (boot, reset) = (starts(), cause());
    let Registers { exception, values: registers } = registers;
    retained::note(&FaultRecord {
        kind,
        boot,
        reset,
        mode,
        steps,
        frame_us,
        causes,
        exception,
        registers,
        text,
    });
}

/// Ends the program: outputs off, then the fault record, then the board's `end`, which restarts.
pub fn end(kind: FaultKind, registers: Registers, text: &str) -> ! {
    board::outputs_off();
    note(kind, registers, text);
    board::end(kind, &registers, text)
}

/// Handles a brown-out. Called by the board's supply warning, at a priority above all but the motor.
pub fn brown_out() -> ! {
    end(FaultKind::BrownOut, Registers::default(), "supply too low")
}
