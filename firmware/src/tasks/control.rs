//! The 1 kHz control task: reads the sensors, runs one control step, sends the torque. Waits only for its next release.

use super::settings;
use crate::deadline::{Deadlines, PERIOD};
use crate::heartbeat::Task;
use crate::telemetry::{self, Telemetry};
use crate::{board, crash, retained};
use ::control::{Mode, Plan, State, step};
use embassy_time::{Instant, Timer};
use link::fault_log;
use link::report::FaultKind;

/// Runs one [`step`] at every whole [`PERIOD`] of the clock, beginning with the next one, with the newest plan of
/// [`settings::queue_plan`].
///
/// Delayed steps are run as soon as possible, so that the number of steps equals the number of elapsed periods; each
/// missed deadline is counted.
#[embassy_executor::task]
pub async fn control(plan: &'static mut Plan) {
    let mut state = State::default();
    let mut deadlines = Deadlines::default();
    let (mut mode, mut configuration) = (Mode::Off, 0);
    let mut release = Instant::from_millis(Instant::now().as_millis());
    loop {
        release += PERIOD;
        Timer::at(release).await;
        if let Some((next, number)) = settings::take_pending_plan(mode, state.torque_nm()) {
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
            polarity_torque_nm: state.polarity_torque_nm(),
            drive,
        };
        telemetry::set(telemetry);
        retained::with(|ring| fault_log::stepped(ring, &telemetry.last_step()));
        if command.mode == Mode::Fault && mode != Mode::Fault {
            crash::note(FaultKind::Controller, crash::Registers::default(), "");
        }
        mode = command.mode;
        Task::Control.report();
    }
}
