//! A display on the CAN bus: what the board broadcast last.

use crate::chip::can::Frame;
use control::{Cause, Causes, Command, Mode};
use link::can::{self, Message, Motion, State};
use sim_host::ride::Stepped;

/// The newest broadcasts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Display {
    /// Where the controller stands.
    pub state: Option<State>,
    /// How the bicycle moves, as the board sees it.
    pub motion: Option<Motion>,
    /// What stands in the way of the torque.
    pub causes: Option<Causes>,
}

impl Display {
    /// Takes what came over the bus.
    pub fn take(&mut self, frames: &[Frame]) {
        for &Frame { identifier, bytes, .. } in frames {
            match Message::of(&can::Frame { identifier, bytes }) {
                Some(Message::State(state)) => self.state = Some(state),
                Some(Message::Motion(motion)) => self.motion = Some(motion),
                Some(Message::Causes(causes)) => self.causes = Some(causes),
                None => (),
            }
        }
    }

    /// The controller's mode; off before the first broadcast.
    pub fn mode(&self) -> Mode {
        self.state.map_or(Mode::Off, |state| state.mode)
    }

    /// Whether the controller is in standby and nothing is missing but the switch.
    pub fn waits_for_the_switch(&self) -> bool {
        self.mode() == Mode::Standby && self.causes == Some(Causes::of(Cause::SwitchOff))
    }

    /// The controller as far as the bus tells, with the torque that the motor gives \[N m\].
    pub(super) fn stepped(&self, torque_nm: f64) -> Stepped {
        let command = Command {
            torque_nm: torque_nm as f32,
            limits: self.state.map_or(Stepped::OFF.command.limits, |state| state.limits),
            mode: self.mode(),
            causes: self.causes.unwrap_or(Causes::NONE),
            ..Stepped::OFF.command
        };
        // The bus tells it in steps of half a percent.
        let authority = self.state.and_then(|state| state.authority).unwrap_or(0.0);
        Stepped { command, authority: if authority > 0.999 { 1.0 } else { authority } }
    }
}
