//! A display on the CAN bus: the board's last broadcasts.

use crate::chip::can::Frame;
use control::{Cause, Causes, Command, Mode};
use link::can::{self, Message, Motion, State};
use sim_host::ride::Stepped;

/// The newest broadcasts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Display {
    /// State of the controller.
    pub state: Option<State>,
    /// Motion of the bicycle, as broadcast.
    pub motion: Option<Motion>,
    /// Causes that prevent torque.
    pub causes: Option<Causes>,
}

impl Display {
    /// Receives frames from the bus.
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

    /// Mode of the controller; off before the first broadcast.
    pub fn mode(&self) -> Mode {
        self.state.map_or(Mode::Off, |state| state.mode)
    }

    /// Whether the controller is in standby and only the switch prevents torque.
    pub fn waits_for_the_switch(&self) -> bool {
        self.mode() == Mode::Standby && self.causes == Some(Causes::of(Cause::SwitchOff))
    }

    /// Controller state from the broadcasts, with the motor torque \[N m\].
    pub(super) fn stepped(&self, torque_nm: f64) -> Stepped {
        let command = Command {
            torque_nm: torque_nm as f32,
            limits: self.state.map_or(Stepped::OFF.command.limits, |state| state.limits),
            mode: self.mode(),
            causes: self.causes.unwrap_or(Causes::NONE),
            ..Stepped::OFF.command
        };
        // The bus has a resolution of half a percent.
        let authority = self.state.and_then(|state| state.authority).unwrap_or(0.0);
        Stepped { command, authority: if authority > 0.999 { 1.0 } else { authority } }
    }
}
