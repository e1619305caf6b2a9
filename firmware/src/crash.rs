//! What is kept when something goes wrong, and what is done first: the outputs go off.

use crate::{board, retained, tasks};
use control::{Causes, Mode};
use core::sync::atomic::{AtomicU32, Ordering};
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
        let newest = link::ring::faults(ring).next();
        newest.is_some_and(|f| f.kind == FaultKind::Watchdog && f.boot.wrapping_add(1) == starts)
    });
    if cause == ResetCause::Watchdog && told == Some(false) {
        note(FaultKind::Watchdog, Registers::default(), "the lowest priority stood still");
    }
}

/// How often the program started.
pub fn starts() -> u32 {
    START.load(Ordering::Relaxed)
}

/// Keeps a fault with what the controller did last. From any context.
pub fn note(kind: FaultKind, registers: Registers, text: &str) {
    let latest = tasks::latest();
    retained::note(&FaultRecord {
        kind,
        boot: starts(),
        reset: ResetCause::numbered(CAUSE.load(Ordering::Relaxed) as u8).unwrap_or_default(),
        mode: latest.as_ref().map_or(Mode::Off, |t| t.command.mode),
        steps: latest.as_ref().map_or(0, |t| t.deadlines.steps),
        frame_us: latest.as_ref().map_or(0, |t| t.frame.now_us),
        causes: latest.as_ref().map_or(Causes::NONE, |t| t.command.causes),
        exception: registers.exception,
        registers: registers.values,
        text,
    });
}

/// The program can't go on: outputs off, then the record, then a new start.
pub fn end(kind: FaultKind, registers: Registers, text: &str) -> ! {
    board::outputs_off();
    note(kind, registers, text);
    board::restart()
}

/// The supply falls below what the chip needs. To be called by the board's warning, above all else but the motor.
pub fn brown_out() -> ! {
    end(FaultKind::BrownOut, Registers::default(), "supply too low")
}
