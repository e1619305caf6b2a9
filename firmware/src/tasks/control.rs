//! The 1 kHz task: sensors in, one step, torque out. It waits for nothing but its next release.

use super::settings;
use crate::deadline::{Deadlines, PERIOD};
use crate::heartbeat::Task;
use crate::{board, crash, retained};
use ::control::sensors::polarity::PolarityStep;
use ::control::{Command, Mode, Plan, SensorFrame, State, step};
use core::cell::RefCell;
use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_time::{Instant, Timer};
use link::fault_log::{self, LastStep};
use link::report::FaultKind;

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
    /// The part of the torque that is permitted, 0 to 1.
    pub authority: f32,
    /// As of [`State::slopes`].
    pub slopes: [Option<f32>; 2],
    /// The number of the configuration it stepped with, as of [`settings::take`].
    pub configuration: u32,
    /// Where the polarity check stands.
    pub polarity: PolarityStep,
    /// The torque that it shows \[N m\].
    pub shown_nm: f32,
    /// Whether the motor got it.
    pub drive: Result<(), Refusal>,
}

impl Telemetry {
    /// Where the controller stood.
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

/// What the control task did last; `None` before its first step, and in a fault of it while it writes.
pub fn latest() -> Option<Telemetry> {
    LATEST.lock(|latest| latest.try_borrow().ok().and_then(|latest| *latest))
}

/// The command of the last step and its authority, as of [`latest`].
pub fn commanded() -> Option<(Command, f32)> {
    let of = |t: &Telemetry| (t.command, t.authority);
    LATEST.lock(|latest| latest.try_borrow().ok().and_then(|latest| latest.as_ref().map(of)))
}

/// Runs one [`step`] at every whole [`PERIOD`] of the clock, the first at the one after its start, with the plan that
/// [`settings::offer`] offered last.
///
/// A step held up is done as soon as possible, and so are those released meanwhile: their number
/// is always that of the periods gone by, and each late one is counted.
#[embassy_executor::task]
pub async fn control(plan: &'static mut Plan) {
    let mut state = State::default();
    let mut deadlines = Deadlines::default();
    let (mut mode, mut configuration) = (Mode::Off, 0);
    let mut release = Instant::from_millis(Instant::now().as_millis());
    loop {
        release += PERIOD;
        Timer::at(release).await;
        if let Some((next, number)) = settings::take(mode) {
            (*plan, configuration) = (next, number);
            (state, mode) = (State::default(), Mode::Off);
        }
        let frame = board::sense();
        let command = step(plan, &mut state, &frame);
        let drive = board::drive(&command);
        deadlines.finished(release, Instant::now());
        let telemetry = Telemetry {
            deadlines,
            frame,
            command,
            authority: state.authority(),
            slopes: state.slopes(),
            configuration,
            polarity: state.polarity(),
            shown_nm: state.hand_torque_nm(),
            drive,
        };
        LATEST.lock(|latest| *latest.borrow_mut() = Some(telemetry));
        retained::with(|ring| fault_log::stepped(ring, &telemetry.last_step()));
        if command.mode == Mode::Fault && mode != Mode::Fault {
            crash::note(FaultKind::Controller, crash::Registers::default(), "");
        }
        mode = command.mode;
        Task::Control.report();
    }
}
