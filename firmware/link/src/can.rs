//! The board's CAN broadcasts: three data frames of eight bytes, classic CAN 2.0A. Table: docs/link.md.
//!
//! Little-endian. A number is rounded to its unit and saturates at its range. An unknown value, or NaN, has a reserved
//! code.

use control::sensors::calibration::CalibrationPlan;
use control::sensors::polarity::PolarityStep;
use control::{ActiveLimits, Causes, Command, Mode, SensorFrame};
use micromath::F32;

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

/// Codes of an unknown value.
const UNKNOWN: i16 = i16::MIN;
const UNKNOWN_U8: u8 = u8::MAX;

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
        match self {
            Message::State(state) => {
                let flags =
                    u8::from(state.driven) | u8::from(state.engage) << 1 | (state.polarity as u8) << 2;
                let ([l0, l1], [v0, v1]) =
                    (state.limits.0.to_le_bytes(), word(state.speed_m_s, SPEED_M_S).to_le_bytes());
                let bytes = [state.mode as u8, flags, l0, l1, part(state.authority), v0, v1, state.steps];
                Frame { identifier: STATE, bytes }
            }
            Message::Motion(motion) => {
                let [r0, r1] = word(motion.roll_rate_rad_s, ROLL_RATE_RAD_S).to_le_bytes();
                let [s0, s1] = word(motion.steer_rad, STEER_RAD).to_le_bytes();
                let [c0, c1] = word(motion.commanded_nm, TORQUE_NM).to_le_bytes();
                let [m0, m1] = word(motion.measured_nm, TORQUE_NM).to_le_bytes();
                Frame { identifier: MOTION, bytes: [r0, r1, s0, s1, c0, c1, m0, m1] }
            }
            Message::Causes(causes) => Frame { identifier: CAUSES, bytes: causes.0.to_le_bytes() },
        }
    }

    /// Decodes a frame; `None` if the identifier, the mode or the polarity step is unknown.
    pub fn of(frame: &Frame) -> Option<Self> {
        let [b0, b1, b2, b3, b4, b5, b6, b7] = frame.bytes;
        match frame.identifier {
            STATE => Some(Message::State(State {
                mode: Mode::numbered(b0)?,
                driven: b1 & 1 != 0,
                engage: b1 & 2 != 0,
                polarity: PolarityStep::numbered(b1 >> 2 & 7)?,
                limits: ActiveLimits(u16::from_le_bytes([b2, b3])),
                authority: (b4 != UNKNOWN_U8).then_some(f32::from(b4) * AUTHORITY),
                speed_m_s: value([b5, b6], SPEED_M_S),
                steps: b7,
            })),
            MOTION => Some(Message::Motion(Motion {
                roll_rate_rad_s: value([b0, b1], ROLL_RATE_RAD_S),
                steer_rad: value([b2, b3], STEER_RAD),
                commanded_nm: value([b4, b5], TORQUE_NM),
                measured_nm: value([b6, b7], TORQUE_NM),
            })),
            CAUSES => Some(Message::Causes(Causes(u64::from_le_bytes(frame.bytes)))),
            _ => None,
        }
    }
}

/// A value in units of `unit`, saturated to -32767..=32767.
fn word(value: Option<f32>, unit: f32) -> i16 {
    match value {
        Some(value) if !value.is_nan() => (F32(value / unit).round().0 as i16).max(-i16::MAX),
        _ => UNKNOWN,
    }
}

/// Value of a word in units of `unit`; `None` if unknown.
fn value(bytes: [u8; 2], unit: f32) -> Option<f32> {
    let word = i16::from_le_bytes(bytes);
    (word != UNKNOWN).then_some(f32::from(word) * unit)
}

/// A fraction from 0 to 1 in units of [`AUTHORITY`].
fn part(part: Option<f32>) -> u8 {
    match part {
        Some(part) if !part.is_nan() => F32(part.clamp(0.0, 1.0) / AUTHORITY).round().0 as u8,
        _ => UNKNOWN_U8,
    }
}
