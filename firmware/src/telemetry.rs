//! Inputs and outputs of the last control step, written by the control task and read by all others.

use crate::deadline::Deadlines;
use ::control::sensors::polarity::PolarityStep;
use ::control::{Command, SensorFrame};
use core::cell::RefCell;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use link::fault_log::LastStep;

/// Reason for which a board gives no torque, whatever the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveError {
    /// The offsets of the current sensors are still being measured.
    NotReady,
    /// The offset of the motor's encoder is unknown.
    NotAligned,
    /// The command timed out; the bridge was open in between.
    Stale,
    /// The gate driver rejected its settings, or reported a fault.
    GateDriver,
    /// The outputs were switched off until the next start.
    OutputsOff,
    /// Fault of the motor loop, by its number in docs/motor.md; over-current is 1.
    MotorFault(u8),
}

impl DriveError {
    /// Text of the reason.
    pub const fn reason(self) -> &'static str {
        match self {
            DriveError::NotReady => "not ready",
            DriveError::NotAligned => "not aligned",
            DriveError::Stale => "command too late",
            DriveError::GateDriver => "gate driver",
            DriveError::OutputsOff => "outputs off",
            DriveError::MotorFault(_) => "motor fault",
        }
    }
}

/// Inputs and outputs of the last control step.
#[derive(Clone, Copy, Debug)]
pub struct Telemetry {
    /// Number of steps, and of missed deadlines.
    pub deadlines: Deadlines,
    /// The sensors of the last step.
    pub frame: SensorFrame,
    /// The resulting command.
    pub command: Command,
    /// Authority, 0 to 1.
    pub authority: f32,
    /// Regression gains of the sign check; [`control::State::slopes`].
    pub slopes: [Option<f32>; 2],
    /// Number of the configuration of the step; see [`crate::tasks::settings`].
    pub configuration: u32,
    /// Step of the polarity check.
    pub polarity: PolarityStep,
    /// Torque shown by the polarity check \[N m\].
    pub polarity_torque_nm: f32,
    /// Whether the motor accepted the command.
    pub drive: Result<(), DriveError>,
}

impl Telemetry {
    /// State of the controller, for the fault log.
    pub fn last_step(&self) -> LastStep {
        LastStep {
            steps: self.deadlines.steps,
            frame_us: self.frame.now_us,
            causes: self.command.causes,
            mode: self.command.mode,
        }
    }
}

static LATEST: Mutex<CriticalSectionRawMutex, RefCell<Option<Telemetry>>> = Mutex::new(RefCell::new(None));

/// Stores the data of a control step.
pub(crate) fn set(telemetry: Telemetry) {
    LATEST.lock(|latest| *latest.borrow_mut() = Some(telemetry));
}

/// Data of the last control step; `None` before the first, and in a fault handler that interrupts their writing.
pub fn latest() -> Option<Telemetry> {
    LATEST.lock(|latest| latest.try_borrow().ok().and_then(|latest| *latest))
}

/// Command and authority of the last step, as in [`latest`].
pub fn commanded() -> Option<(Command, f32)> {
    let of = |t: &Telemetry| (t.command, t.authority);
    LATEST.lock(|latest| latest.try_borrow().ok().and_then(|latest| latest.as_ref().map(of)))
}
