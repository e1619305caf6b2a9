//! Warm start before the disturbance: the bicycle rides upright and straight; the controller boots, runs its
//! self-test and is engaged by a press of the switch, all by the flashed control step.

use super::backend::{Backend, Stepped};
use super::hardware::{self, RideHardware};
use super::sensor::{Reading, frame};
use super::{Assist, Conditions, Start};
use crate::plant::{Plant, Reading as ExactReading};
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

/// A controller after a warm start.
#[derive(Clone, Debug)]
pub struct Engaged {
    /// Its state.
    pub state: State,
    /// Control periods since its boot.
    pub ticks: u32,
    /// Its last command.
    pub command: Command,
}

impl Engaged {
    /// The controller at its boot.
    pub fn boot() -> Self {
        Self { state: State::default(), ticks: 0, command: Stepped::OFF.command }
    }
}

/// The controller after a warm start at a speed \[m/s\] in the gravity `g` \[m/s^2\], all its sensors exact.
pub fn engaged(plan: &Plan, speed_m_s: f64, g: f64) -> Engaged {
    let steady = ExactReading::steady(speed_m_s, g);
    let measured = |ticks, pressed, motor_torque_nm| {
        let reading = ExactReading { motor_torque_nm, ..steady };
        hardware::exact_frame(plan, &reading, ticks, pressed)
    };
    let mut last = Stepped::OFF.command;
    let Ready { controller, ticks } =
        engage_run(plan, &mut Backend::Local, measured, |_, command| last = *command);
    Engaged { state: controller, ticks, command: last }
}

/// Frames of exact sensors in steady riding at a speed \[m/s\].
pub(super) fn steady(plan: &Plan, speed_m_s: f64) -> impl FnMut(u32, bool, f64) -> SensorFrame {
    let reading = Reading { roll_rate_rad_s: 0.0, speed_m_s };
    move |ticks, pressed, _| frame(plan, &reading, ticks, pressed)
}

/// State of a ride at t = 0: the controller, and sensors and motor if they are not exact.
#[derive(Debug)]
pub(super) struct Warm {
    pub(super) ready: Ready,
    pub(super) hardware: Option<Box<RideHardware>>,
}

impl Warm {
    /// A copy for another ride from the same speed; `None` if anything is random.
    fn copied(&self) -> Option<Self> {
        let ready = self.ready.clone();
        match &self.hardware {
            None => Some(Self { ready, hardware: None }),
            Some(hardware) => {
                hardware.copied().map(|hardware| Self { ready, hardware: Some(Box::new(hardware)) })
            }
        }
    }
}

/// Cache of warm starts by speed \[m/s\]: rides from the same speed share one if the control step is executed in this program
/// and nothing is random.
#[derive(Debug, Default)]
pub(super) struct WarmStart(Vec<(f64, Warm)>);

impl WarmStart {
    /// The state after a warm start with the sensors and the motor of `plant`, if the assist has one. `simulated`: whether
    /// they are needed.
    pub(super) fn at(
        &mut self,
        conditions: &Conditions,
        (plant, simulated): (&Plant, bool),
        backend: &mut Backend,
        start: &Start,
    ) -> Option<Warm> {
        let Assist::Firmware(plan) = &conditions.assist else { return None };
        let known = self.0.iter().find(|(speed, _)| *speed == start.speed_m_s);
        if let Some((_, warm)) = known.filter(|_| backend.shares()) {
            return warm.copied();
        }
        let warm = if simulated {
            let (hardware, ready) = RideHardware::new(conditions, plan, plant, start, backend, |_| ());
            Warm { ready, hardware: Some(Box::new(hardware)) }
        } else {
            let ready = engage_run(plan, backend, steady(plan, start.speed_m_s), |_, _| ());
            Warm { ready, hardware: None }
        };
        if let Some(copy) = warm.copied().filter(|_| backend.shares()) {
            self.0.push((start.speed_m_s, copy));
        }
        Some(warm)
    }
}
