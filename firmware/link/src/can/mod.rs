//! The board's CAN broadcasts: three data frames of eight bytes, classic CAN 2.0A. Table: docs/link.md.
//!
//! Little-endian. A number is rounded to its unit and saturates at its range. An unknown value, or NaN, has a reserved
//! code. [`layout`] has the places and codes of all numbers.

pub mod layout;
pub mod signal;

use control::sensors::calibration::CalibrationPlan;
use control::sensors::polarity::PolarityStep;
use control::{ActiveLimits, Causes, Command, Mode, SensorFrame};
use signal::Signal;

/// Bit rate \[bit/s\].
pub const BIT_HZ: u32 = 500_000;
/// Time between two broadcasts of all frames \[ms\].
pub const PERIOD_MS: u64 = 20;
/// Age from which a sample counts as unknown \[control periods\].
pub const STALE_TICKS: u16 = 250;

/// Identifier of the state frame; lower identifiers win arbitration, so the most urgent frame is first.
pub const STATE: u16 = 0x320;
/// Identifier of the motion frame.
pub const MOTION: u16 = 0x321;
/// Identifier of the causes frame, codes 0 to 63; the next identifier is reserved for 64 to 127.
pub const CAUSES: u16 = 0x322;

/// One unit of the speed \[m/s\].
pub const SPEED_M_S: f32 = 1e-3;
/// One unit of the roll rate \[rad/s\].
pub const ROLL_RATE_RAD_S: f32 = 1e-3;
/// One unit of the steer angle \[rad\].
pub const STEER_RAD: f32 = 1e-4;
/// One unit of a torque \[N m\].
pub const TORQUE_NM: f32 = 2e-3;
/// One unit of the authority.
pub const AUTHORITY: f32 = 5e-3;

/// A data frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Identifier, 11 bits.
    pub identifier: u16,
    /// Data bytes.
    pub bytes: [u8; 8],
}

/// State of the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Mode of the controller.
    pub mode: Mode,
    /// Whether the motor accepts torque.
    pub driven: bool,
    /// Whether the rider's switch requests assist.
    pub engage: bool,
    /// Next step of the polarity check.
    pub polarity: PolarityStep,
    /// Limits that changed the torque.
    pub limits: ActiveLimits,
    /// Authority, 0 to 1.
    pub authority: Option<f32>,
    /// Rate of the rear wheel times its radius \[m/s\], positive forward.
    pub speed_m_s: Option<f32>,
    /// Lowest byte of the control step counter; a constant value means that control has stopped.
    pub steps: u8,
}

/// Motion of the bicycle in its own axes: positive to the right.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Gyro rate about the forward axis \[rad/s\].
    pub roll_rate_rad_s: Option<f32>,
    /// Steer angle \[rad\].
    pub steer_rad: Option<f32>,
    /// Torque requested from the motor \[N m\].
    pub commanded_nm: Option<f32>,
    /// Torque reported by the motor \[N m\].
    pub measured_nm: Option<f32>,
}

impl Motion {
    /// Converts from the axes, zeros and signs of the sensors and the motor.
    pub fn of(calibration: &CalibrationPlan, frame: &SensorFrame, command: &Command) -> Self {
        let [roll_rate_rad_s, ..] = calibration.gyro(&frame.gyro_rad_s);
        Self {
            roll_rate_rad_s: fresh(roll_rate_rad_s, frame.gyro_rad_s.age_ticks),
            steer_rad: fresh(calibration.steer(&frame.steer_rad), frame.steer_rad.age_ticks),
            // The sign is its own inverse: the calibration converts in both directions.
            commanded_nm: Some(calibration.motor(command.torque_nm)),
            measured_nm: fresh(
                calibration.motor_report(&frame.motor_torque_nm),
                frame.motor_torque_nm.age_ticks,
            ),
        }
    }
}

/// The value of a sample younger than [`STALE_TICKS`], else `None`.
pub fn fresh(value: f32, age_ticks: u16) -> Option<f32> {
    (age_ticks < STALE_TICKS).then_some(value)
}

/// Content of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Message {
    /// State of the controller.
    State(State),
    /// Motion of the bicycle.
    Motion(Motion),
    /// All causes that prevent or reduce torque, or are reported.
    Causes(Causes),
}

impl Message {
    /// Encodes the message as a frame.
    pub fn frame(&self) -> Frame {
        use layout::*;
        let (identifier, bits) = match self {
            Message::State(state) => (
                STATE,
                MODE.put(state.mode as u64)
                    | DRIVEN.put(state.driven.into())
                    | ENGAGE.put(state.engage.into())
                    | POLARITY.put(state.polarity as u64)
                    | LIMITED.put(state.limits.0.into())
                    | AUTHORITY_PART.put(PART.code(state.authority))
                    | SPEED.put(FORWARD.code(state.speed_m_s))
                    | STEPS.put(state.steps.into()),
            ),
            Message::Motion(motion) => (
                MOTION,
                ROLL_RATE.put(RATE.code(motion.roll_rate_rad_s))
                    | STEER.put(ANGLE.code(motion.steer_rad))
                    | COMMANDED.put(TORQUE.code(motion.commanded_nm))
                    | MEASURED.put(TORQUE.code(motion.measured_nm)),
            ),
            Message::Causes(causes) => (CAUSES, causes.0),
        };
        Frame { identifier, bytes: bits.to_le_bytes() }
    }

    /// Decodes a frame; `None` if the identifier, the mode or the polarity step is unknown.
    pub fn of(frame: &Frame) -> Option<Self> {
        use layout::*;
        let bits = u64::from_le_bytes(frame.bytes);
        let byte = |signal: Signal| signal.get(bits) as u8;
        let word = |signal: Signal| signal.get(bits) as i16;
        match frame.identifier {
            STATE => Some(Message::State(State {
                mode: Mode::numbered(byte(MODE))?,
                driven: DRIVEN.get(bits) != 0,
                engage: ENGAGE.get(bits) != 0,
                polarity: PolarityStep::numbered(byte(POLARITY))?,
                limits: ActiveLimits(LIMITED.get(bits) as u16),
                authority: PART.value(word(AUTHORITY_PART)),
                speed_m_s: FORWARD.value(word(SPEED)),
                steps: byte(STEPS),
            })),
            MOTION => Some(Message::Motion(Motion {
                roll_rate_rad_s: RATE.value(word(ROLL_RATE)),
                steer_rad: ANGLE.value(word(STEER)),
                commanded_nm: TORQUE.value(word(COMMANDED)),
                measured_nm: TORQUE.value(word(MEASURED)),
            })),
            CAUSES => Some(Message::Causes(Causes(bits))),
            _ => None,
        }
    }
}
