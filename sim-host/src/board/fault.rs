//! A fault record as text.

use super::causes::{NamedCause, named};
use super::exception::Exception;
use super::printable::printable;
use link::report::{FaultKind, FaultRecord};
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt;

/// A fault record with names in place of numbers.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Fault {
    /// "panic", "exception", "watchdog", "controller", "brown-out" or "drive".
    pub kind: &'static str,
    /// Number of the program start that recorded it; a watchdog reset is recorded by the following start.
    pub boot: u32,
    /// Reset reason of that start.
    pub reset: &'static str,
    /// The controller's mode at the last control step before the fault.
    pub mode: &'static str,
    /// Control steps done before the fault.
    pub steps: u32,
    /// The board's clock at the last control step \[s\]; wraps every 4295 s.
    pub frame_s: f64,
    /// The controller's causes at the last control step.
    pub causes: Vec<NamedCause>,
    /// The core's exception registers; null if the fault is no exception.
    pub exception: Option<Exception>,
    /// Text of the record: a panic's location and message.
    pub text: String,
}

impl From<FaultRecord<'_>> for Fault {
    fn from(record: FaultRecord<'_>) -> Self {
        let of_core = record.kind == FaultKind::Exception;
        Self {
            kind: record.kind.name(),
            boot: record.boot,
            reset: record.reset.name(),
            mode: record.mode.name(),
            steps: record.steps,
            frame_s: f64::from(record.frame_us) * 1e-6,
            causes: named(record.causes),
            exception: of_core.then(|| Exception::new(record.exception, record.registers)),
            text: record.text.into(),
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kind, boot, reset, mode, steps, frame_s, causes, exception, text } = self;
        writeln!(f, "{kind} in start {boot} ({reset}), after {steps} steps at {frame_s:.3} s, mode {mode}")?;
        if !text.is_empty() {
            writeln!(f, "  {}", printable(text).replace('\n', "\n  "))?;
        }
        if let Some(Exception { number, name, status, cfsr, hfsr, bfar, sp, pc, lr }) = exception {
            writeln!(
                f,
                "  exception {number}, {name}: pc {pc} lr {lr} sp {sp} cfsr {cfsr} hfsr {hfsr} bfar {bfar}"
            )?;
            status.iter().try_for_each(|meaning| writeln!(f, "    {meaning}"))?;
        }
        causes.iter().try_for_each(|cause| {
            writeln!(f, "  {} {}: {} ({})", cause.code, cause.name, cause.meaning, cause.page)
        })
    }
}
