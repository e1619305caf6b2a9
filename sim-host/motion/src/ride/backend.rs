//! Executes the control step of a ride: in this program, or on an external processor.

use super::Start;
use control::{ActiveLimits, Causes, Command, Mode, Plan, SensorFrame, State};

/// Result of one control step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepped {
    /// The command.
    pub command: Command,
    /// Authority, 0 to 1.
    pub authority: f32,
}

impl Stepped {
    /// Result of a controller that is off.
    pub const OFF: Self = Self {
        command: Command {
            torque_nm: 0.0,
            gain_nm_s_rad: 0.0,
            limits: ActiveLimits(0),
            mode: Mode::Off,
            causes: Causes::NONE,
        },
        authority: 0.0,
    };
}

/// Failure of an external processor: its error, which `downcast_ref` gives.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct RemoteError(pub Box<dyn std::error::Error + Send + Sync>);

/// A controller on an external processor.
pub trait Remote {
    /// Begins a ride: restarts the controller with the configuration of `plan`.
    ///
    /// # Errors
    /// The controller can't be restarted.
    fn begin(&mut self, plan: &Plan, start: &Start) -> Result<(), RemoteError>;

    /// Marks the next step as t = 0, the instant of the disturbance.
    fn disturb(&mut self);

    /// Executes one control step.
    ///
    /// # Errors
    /// The processor does not answer.
    fn step(&mut self, frame: &SensorFrame) -> Result<Stepped, RemoteError>;
}

/// Where the control step is executed.
pub(super) enum Backend<'a> {
    /// In this program.
    Local,
    /// In this program, until the function, called before every step, returns true.
    Until(&'a dyn Fn() -> bool),
    /// On an external processor; not called again after its first failure.
    Remote {
        /// The external controller.
        remote: &'a mut dyn Remote,
        /// Its first failure.
        failure: Option<RemoteError>,
    },
}

impl<'a> Backend<'a> {
    /// Execution on an external processor.
    pub(super) fn remote(remote: &'a mut dyn Remote) -> Self {
        Self::Remote { remote, failure: None }
    }

    /// Whether rides from the same speed can share one warm start.
    pub(super) fn shares(&self) -> bool {
        matches!(self, Self::Local | Self::Until(_))
    }

    /// Whether the processor failed or the ride was stopped, so that it is invalid.
    pub(super) fn failed(&self) -> bool {
        match self {
            Self::Local => false,
            Self::Until(stop) => stop(),
            Self::Remote { failure, .. } => failure.is_some(),
        }
    }

    /// Returns the failure, if any.
    pub(super) fn end(self) -> Result<(), RemoteError> {
        match self {
            Self::Local | Self::Until(_) | Self::Remote { failure: None, .. } => Ok(()),
            Self::Remote { failure: Some(error), .. } => Err(error),
        }
    }

    /// Begins a ride from `start`.
    pub(super) fn begin(&mut self, plan: &Plan, start: &Start) {
        if let Self::Remote { remote, failure: failure @ None } = self {
            *failure = remote.begin(plan, start).err();
        }
    }

    /// Marks the next step as t = 0.
    pub(super) fn disturb(&mut self) {
        if let Self::Remote { remote, failure: None } = self {
            remote.disturb();
        }
    }

    /// Executes one control step; `state` is the local controller's. After a failure the result is zero
    /// torque.
    #[inline]
    pub(super) fn step(&mut self, plan: &Plan, state: &mut State, frame: &SensorFrame) -> Stepped {
        match self {
            Self::Local | Self::Until(_) => {
                let command = control::step(plan, state, frame);
                Stepped { command, authority: state.authority() }
            }
            Self::Remote { failure: Some(_), .. } => Stepped::OFF,
            Self::Remote { remote, failure } => remote.step(frame).unwrap_or_else(|error| {
                *failure = Some(error);
                Stepped::OFF
            }),
        }
    }
}
