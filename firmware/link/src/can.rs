//! What the board tells on CAN: three data frames of eight bytes, classic CAN 2.0A. docs/link.md has them as a table.
//!
//! Little-endian. A number is rounded to its unit and stops at the ends of its range; what is not known, or NaN, has a
//! value of its own.

use control::sensors::calibration::CalibrationPlan;
use control::sensors::polarity::PolarityStep;
use control::{ActiveLimits, Causes, Command, Mode, SensorFrame};
use micromath::F32;

/// Bit rate \[bit/s\].
pub const BIT_HZ: u32 = 500_000;
/// Time between two broadcasts of all frames \[ms\].
pub const PERIOD_MS: u64 = 20;
/// Age from which a sample is not known any more \[control periods\].
pub const STALE_TICKS: u16 = 250;

/// Identifiers of the frames, the most urgent first.
pub const STATE: u16 = 0x320;
/// As of [`STATE`].
pub const MOTION: u16 = 0x321;
/// As of [`STATE`].
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

/// Stand for a value that is not known.
const UNKNOWN: i16 = i16::MIN;
const UNKNOWN_U8: u8 = u8::MAX;

/// A data frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Its identifier, 11 bits.
    pub identifier: u16,
    /// Its data.
    pub bytes: [u8; 8],
}

/// Where the controller stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Its mode.
    pub mode: Mode,
    /// Whether the motor takes torque.
    pub driven: bool,
    /// Whether the rider's switch asks for assist.
    pub engage: bool,
    /// What is to be done next in the polarity check.
    pub polarity: PolarityStep,
    /// The limits that changed the torque.
    pub limits: ActiveLimits,
    /// The part of the torque that is permitted, 0 to 1.
    pub authority: Option<f32>,
    /// Rate of the rear wheel times its radius \[m/s\], positive forward.
    pub speed_m_s: Option<f32>,
    /// The lowest byte of the number of control steps: while it stands still, so does control.
    pub steps: u8,
}

/// How the bicycle moves, in its own axes: positive to the right.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// The gyro's rate about the forward axis \[rad/s\].
    pub roll_rate_rad_s: Option<f32>,
    /// Steer angle \[rad\].
    pub steer_rad: Option<f32>,
    /// The torque that is asked of the motor \[N m\].
    pub commanded_nm: Option<f32>,
    /// The torque that the motor says it gives \[N m\].
    pub measured_nm: Option<f32>,
}

impl Motion {
    /// From the sensors' own axes, zeros and signs, and the motor's.
    pub fn of(calibration: &CalibrationPlan, frame: &SensorFrame, command: &Command) -> Self {
        let [roll_rate_rad_s, ..] = calibration.gyro(&frame.gyro_rad_s);
        Self {
            roll_rate_rad_s: fresh(roll_rate_rad_s, frame.gyro_rad_s.age_ticks),
            steer_rad: fresh(calibration.steer(&frame.steer_rad), frame.steer_rad.age_ticks),
            // A sign that is applied twice is gone.
            commanded_nm: Some(calibration.motor(command.torque_nm)),
            measured_nm: fresh(
                calibration.motor_report(&frame.motor_torque_nm),
                frame.motor_torque_nm.age_ticks,
            ),
        }
    }
}

/// A sensor's value while it is known.
pub fn fresh(value: f32, age_ticks: u16) -> Option<f32> {
    (age_ticks < STALE_TICKS).then_some(value)
}

/// What a frame says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Message {
    /// Where the controller stands.
    State(State),
    /// How the bicycle moves.
    Motion(Motion),
    /// Everything that stands in the way of the torque, or is worth knowing.
    Causes(Causes),
}

impl Message {
    /// Its frame.
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

    /// What a frame says; `None` if its identifier, mode or move is none of the board's.
    pub fn of(frame: &Frame) -> Option<Self> {
        let [b0, b1, b2, b3, b4, b5, b6, b7] = frame.bytes;
        match frame.identifier {
            STATE => Some(Message::State(State {
                mode: mode(b0)?,
                driven: b1 & 1 != 0,
                engage: b1 & 2 != 0,
                polarity: polarity(b1 >> 2 & 7)?,
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

/// A value in units of `unit`, from -32767 to 32767.
fn word(value: Option<f32>, unit: f32) -> i16 {
    match value {
        Some(value) if !value.is_nan() => (F32(value / unit).round().0 as i16).max(-i16::MAX),
        _ => UNKNOWN,
    }
}

/// The value of a word.
fn value(bytes: [u8; 2], unit: f32) -> Option<f32> {
    let word = i16::from_le_bytes(bytes);
    (word != UNKNOWN).then_some(f32::from(word) * unit)
}

/// A part from 0 to 1 in units of [`AUTHORITY`].
fn part(part: Option<f32>) -> u8 {
    match part {
        Some(part) if !part.is_nan() => F32(part.clamp(0.0, 1.0) / AUTHORITY).round().0 as u8,
        _ => UNKNOWN_U8,
    }
}

/// The mode of a number on the bus.
fn mode(number: u8) -> Option<Mode> {
    use Mode::*;
    [Off, Initialise, SelfTest, Standby, Engaged, Limp, Fault].into_iter().find(|mode| *mode as u8 == number)
}

/// The move of a number on the bus.
fn polarity(number: u8) -> Option<PolarityStep> {
    use PolarityStep::*;
    [Lean, Steer, Push, Passed, Wrong].into_iter().find(|next| *next as u8 == number)
}
