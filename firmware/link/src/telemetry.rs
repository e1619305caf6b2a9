//! Telemetry: inputs and outputs of one control step.

use crate::bytes::{Reader, Writer};
use control::wire::{CAUSE_BYTES, FRAME_BYTES, decode_causes, decode_frame, encode_command, encode_frame};
use control::{ActiveLimits, Causes, Command, Mode, SensorFrame};

/// One control step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Telemetry {
    /// Number of steps, this one included, wrapping.
    pub steps: u32,
    /// Number of steps that missed their deadline, wrapping.
    pub late: u32,
    /// Whether the command was sent to the motor.
    pub driven: bool,
    /// The resulting command, with mode, causes and limits.
    pub command: Command,
    /// Slopes of gyro and motor from the sign check; [`control::State::slopes`].
    pub slopes: [Option<f32>; 2],
    /// Next step of the polarity check, as the number of [`control::sensors::polarity::PolarityStep`].
    pub polarity: u8,
    /// Torque that the law would request during the check \[N m\]; [`control::State::polarity_torque_nm`].
    pub polarity_torque_nm: f32,
    /// The sensors of this step. Last, so that a new sensor extends the message at its end.
    pub frame: SensorFrame,
}

impl Telemetry {
    /// Encodes the step.
    pub fn encode(&self, to: &mut Writer<'_>) {
        to.u32(self.steps);
        to.u32(self.late);
        to.u8(u8::from(self.driven));
        to.put(&encode_command(&self.command));
        self.slopes.into_iter().for_each(|slope| to.scalar(slope));
        to.u8(self.polarity);
        to.f32(self.polarity_torque_nm);
        to.put(&encode_frame(&self.frame));
    }

    /// Decodes a step; `None` for too few bytes or an unknown mode.
    pub fn decode(from: &mut Reader<'_>) -> Option<Self> {
        Some(Self {
            steps: from.u32()?,
            late: from.u32()?,
            driven: from.u8()? == 1,
            command: command(from)?,
            slopes: [from.scalar()?, from.scalar()?],
            polarity: from.u8()?,
            polarity_torque_nm: from.f32()?,
            frame: frame(from)?,
        })
    }
}

/// Decodes a sensor frame; every bit pattern is valid.
pub fn frame(from: &mut Reader<'_>) -> Option<SensorFrame> {
    from.chunk::<FRAME_BYTES>().map(decode_frame)
}

/// Decodes a set of causes.
pub fn causes(from: &mut Reader<'_>) -> Option<Causes> {
    from.chunk::<CAUSE_BYTES>().map(decode_causes)
}

/// Decodes a command as [`encode_command`] encodes it; `None` for an unknown mode.
pub fn command(from: &mut Reader<'_>) -> Option<Command> {
    Some(Command {
        torque_nm: from.f32()?,
        gain_nm_s_rad: from.f32()?,
        limits: ActiveLimits(from.u16()?),
        mode: Mode::numbered(from.u8()?)?,
        causes: causes(from)?,
    })
}
