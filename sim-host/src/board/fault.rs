//! A fault record in words.

use super::causes::{NamedCause, named};
use super::exception::Exception;
use super::printable::printable;
use link::report::{FaultKind, FaultRecord};
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt;

/// A fault record in words.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Fault {
    /// "panic", "exception", "watchdog", "controller", "brown-out" or "drive".
    pub kind: &'static str,
    /// Number of the program's start that recorded it; a watchdog's is recorded by the start after it.
    pub boot: u32,
    /// Why the program was started that time.
    pub reset: &'static str,
    /// The controller's mode at the last control step before it.
    pub mode: &'static str,
    /// Control steps done before it.
    pub steps: u32,
    /// The board's clock at the last of them \[s\], from 0 again every 4295 s.
    pub frame_s: f64,
    /// The controller's causes at the last of them.
    pub causes: Vec<NamedCause>,
    /// What the core said; null if the fault is none of the core's.
    pub exception: Option<Exception>,
    /// In words: a panic's place and message.
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
