//! Warm start before the disturbance: the bicycle rides upright and straight; the controller boots, runs its
//! self-test and is engaged by a press of the switch, all by the flashed control step.

use super::backend::{Backend, Stepped};
use super::sensor::{Reading, frame};
use super::{Assist, Conditions};
use control::{Command, Plan, SensorFrame, State};

/// The controller at t = 0.
#[derive(Clone, Debug)]
pub(super) struct Ready {
    pub(super) controller: State,
    /// Control periods since boot.
    pub(super) ticks: u32,
}

/// Simulates steady riding until the assist has full authority. `measured` gives the frame from the control
/// periods since boot, the switch and the last commanded torque \[N m\]; `observe` receives every frame and
/// command. The switch is pressed once no other condition is missing, and released if the press is rejected.
/// After ten times the expected time the ride starts with a controller that is not engaged.
pub(super) fn engage_run(
    plan: &Plan,
    backend: &mut Backend,
    mut measured: impl FnMut(u32, bool, f64) -> SensorFrame,
    mut observe: impl FnMut(&SensorFrame, &Command),
) -> Ready {
    let mut controller = State::default();
    let (mut pressed, mut ticks, mut torque_nm) = (false, 0, 0.0);
    while ticks < 10 * plan.ticks_to_engage() {
        let measured = measured(ticks, pressed, torque_nm);
        let Stepped { command, authority } = backend.step(plan, &mut controller, &measured);
        ticks += 1;
        torque_nm = f64::from(command.torque_nm);
        observe(&measured, &command);
        pressed = plan.ready(&command) || command.mode.drives();
        if authority == 1.0 || backend.failed() {
            break;
        }
    }
    Ready { controller, ticks }
}

/// Frames of exact sensors in steady riding at a speed \[m/s\].
pub(super) fn steady(plan: &Plan, speed_m_s: f64) -> impl FnMut(u32, bool, f64) -> SensorFrame {
    let reading = Reading { roll_rate_rad_s: 0.0, speed_m_s };
    move |ticks, pressed, _| frame(plan, &reading, ticks, pressed)
}

/// Cache of the last warm start: rides from the same speed share it if the control step is executed in this
/// program.
#[derive(Default)]
pub(super) struct WarmStart(Option<(f64, Ready)>);

impl WarmStart {
    /// The controller after a warm start at this speed \[m/s\], if the assist has one.
    pub(super) fn at(
        &mut self,
        conditions: &Conditions,
        backend: &mut Backend,
        speed_m_s: f64,
    ) -> Option<Ready> {
        let Assist::Firmware(plan) = &conditions.assist else { return None };
        match &self.0 {
            Some((speed, ready)) if *speed == speed_m_s && backend.shares() => Some(ready.clone()),
            _ => {
                let ready = engage_run(plan, backend, steady(plan, speed_m_s), |_, _| ());
                self.0 = Some((speed_m_s, ready.clone()));
                Some(ready)
            }
        }
    }
}
