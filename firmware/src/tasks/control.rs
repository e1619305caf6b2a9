//! The 1 kHz task: sensors in, one step, torque out. It waits for nothing but its next release.

use crate::board;
use crate::deadline::{Deadlines, PERIOD};
use ::control::{Command, Plan, SensorFrame, State, step};
use core::cell::Cell;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_time::{Instant, Timer};

/// Why a board gives no torque, whatever is commanded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The motor is not ready yet: the zeros of its current sensors are being taken.
    NotReady,
    /// The offset of the motor's encoder is not known.
    NotAligned,
    /// The last command came too late; the bridge was open meanwhile.
    Stale,
    /// The gate driver did not take its settings, or told of a fault.
    GateDriver,
    /// The outputs were switched off until the next start.
    OutputsOff,
    /// The motor's loop found a fault, of this number in docs/motor.md: over-current is 1.
    MotorFault(u8),
}

impl Refusal {
    /// The reason in words.
    pub const fn reason(self) -> &'static str {
        match self {
            Refusal::NotReady => "not ready",
            Refusal::NotAligned => "not aligned",
            Refusal::Stale => "command too late",
            Refusal::GateDriver => "gate driver",
            Refusal::OutputsOff => "outputs off",
            Refusal::MotorFault(_) => "motor fault",
        }
    }
}

/// What the control task did last.
#[derive(Clone, Copy, Debug)]
pub struct Telemetry {
    /// Steps so far, and how late.
    pub deadlines: Deadlines,
    /// The sensors of the last step.
    pub frame: SensorFrame,
    /// The command made of them.
    pub command: Command,
    /// Whether the motor got it.
    pub drive: Result<(), Refusal>,
}

static LATEST: Mutex<CriticalSectionRawMutex, Cell<Option<Telemetry>>> = Mutex::new(Cell::new(None));

/// What the control task did last; `None` before its first step.
pub fn latest() -> Option<Telemetry> {
    LATEST.lock(Cell::get)
}

/// Runs one [`step`] at every whole [`PERIOD`] of the clock, the first at the one after its start.
///
/// A step held up is done as soon as possible, and so are those released meanwhile: their number
/// is always that of the periods gone by, and each late one is counted.
#[embassy_executor::task]
pub async fn control(plan: &'static Plan) {
    let mut state = State::default();
    let mut deadlines = Deadlines::default();
    let mut release = Instant::from_millis(Instant::now().as_millis());
    loop {
        release += PERIOD;
        Timer::at(release).await;
        let frame = board::sense();
        let command = step(plan, &mut state, &frame);
        let drive = board::drive(&command);
        deadlines.finished(release, Instant::now());
        LATEST.lock(|latest| latest.set(Some(Telemetry { deadlines, frame, command, drive })));
    }
}
