//! What is kept when something goes wrong, and what is done first: the outputs go off.

use crate::{board, retained, tasks};
use core::sync::atomic::{AtomicU32, Ordering};
use link::fault_log::{self, LastStep};
use link::report::{FaultKind, FaultRecord, ResetCause};

/// How often the program started, and why this time.
static START: AtomicU32 = AtomicU32::new(0);
static CAUSE: AtomicU32 = AtomicU32::new(0);

/// What else there is to say of a processor's exception; all 0 of anything else.
#[derive(Clone, Copy, Debug, Default)]
pub struct Registers {
    /// The exception's number.
    pub exception: u32,
    /// CFSR, HFSR, BFAR, SP, PC, LR.
    pub values: [u32; 6],
}

/// To be called first of all, with the cause of this start. A watchdog's bite of which nobody left word before is kept
/// now.
pub fn start(cause: ResetCause) {
    let starts = retained::start();
    START.store(starts, Ordering::Relaxed);
    CAUSE.store(cause as u32, Ordering::Relaxed);
    let told = retained::with(|ring| {
        let newest = fault_log::faults(ring).next();
        newest.is_some_and(|f| f.kind == FaultKind::Watchdog && f.boot.wrapping_add(1) == starts)
    });
    if cause == ResetCause::Watchdog && told == Some(false) {
        let last = retained::with(|ring| fault_log::last_step(ring)).flatten().unwrap_or_default();
        keep(FaultKind::Watchdog, &last, Registers::default(), "the lowest priority stood still");
    }
}

/// How often the program started.
pub fn starts() -> u32 {
    START.load(Ordering::Relaxed)
}

/// Why it did this time.
pub fn cause() -> ResetCause {
    ResetCause::numbered(CAUSE.load(Ordering::Relaxed) as u8).unwrap_or_default()
}

/// Keeps a fault with what the controller did last. From any context.
pub fn note(kind: FaultKind, registers: Registers, text: &str) {
    keep(kind, &tasks::latest().map_or_else(LastStep::default, |t| t.last_step()), registers, text);
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

/// The program can't go on: outputs off, then the record, then the board's end, a new start.
pub fn end(kind: FaultKind, registers: Registers, text: &str) -> ! {
    board::outputs_off();
    note(kind, registers, text);
    board::end(kind, &registers, text)
}

/// The supply falls below what the chip needs. To be called by the board's warning, above all else but the motor.
pub fn brown_out() -> ! {
    end(FaultKind::BrownOut, Registers::default(), "supply too low")
}
