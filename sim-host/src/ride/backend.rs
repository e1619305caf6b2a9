//! Where the control step of a ride runs: in this program, or on a processor of its own.

use super::Start;
use control::{ActiveLimits, Causes, Command, Mode, Plan, SensorFrame, State};

/// One control step's answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepped {
    /// The command.
    pub command: Command,
    /// The part of the torque that is permitted, 0 to 1.
    pub authority: f32,
}

impl Stepped {
    /// Of a controller that is off.
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

/// Why a processor of its own gave no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct RemoteError(pub String);

/// A controller on a processor of its own.
pub trait Remote {
    /// A ride begins: the controller is just started, with the configuration of `plan`.
    ///
    /// # Errors
    /// It can't be.
    fn begin(&mut self, plan: &Plan, start: &Start) -> Result<(), RemoteError>;

    /// The next step is that of t = 0, when the disturbance comes.
    fn disturb(&mut self);

    /// One control step.
    ///
    /// # Errors
    /// There is no answer, and none will come.
    fn step(&mut self, frame: &SensorFrame) -> Result<Stepped, RemoteError>;
}

/// Where the control step runs.
pub(super) enum Backend<'a> {
    /// In this program.
    Local,
    /// On a processor of its own; after its first failure nothing is asked of it any more.
    Remote {
        /// The controller there.
        remote: &'a mut dyn Remote,
        /// Its failure.
        failure: Option<RemoteError>,
    },
}

impl<'a> Backend<'a> {
    /// On a processor of its own.
    pub(super) fn away(remote: &'a mut dyn Remote) -> Self {
        Self::Remote { remote, failure: None }
    }

    /// Whether rides from the same speed may share a controller made ready once.
    pub(super) fn shares(&self) -> bool {
        matches!(self, Self::Local)
    }

    /// Whether it failed, so that a ride is of no use.
    pub(super) fn failed(&self) -> bool {
        matches!(self, Self::Remote { failure: Some(_), .. })
    }

    /// Its failure, if it failed.
    pub(super) fn end(self) -> Result<(), RemoteError> {
        match self {
            Self::Local | Self::Remote { failure: None, .. } => Ok(()),
            Self::Remote { failure: Some(error), .. } => Err(error),
        }
    }

    /// A ride from `start` begins.
    pub(super) fn begin(&mut self, plan: &Plan, start: &Start) {
        if let Self::Remote { remote, failure: failure @ None } = self {
            *failure = remote.begin(plan, start).err();
        }
    }

    /// The next step is that of t = 0.
    pub(super) fn disturb(&mut self) {
        if let Self::Remote { remote, .. } = self {
            remote.disturb();
        }
    }

    /// One control step; `state` is the controller that runs here. After a failure the answer is zero torque.
    #[inline]
    pub(super) fn step(&mut self, plan: &Plan, state: &mut State, frame: &SensorFrame) -> Stepped {
        match self {
            Self::Local => {
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
