//! The validated measurements of one control period, and the interval that bounds a wheel's speed.

use crate::fault::Causes;
use crate::sensors::monitor::CheckedSample;

/// Bounds of a speed, and its newest sample \[m/s\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct SpeedInterval {
    /// Lower bound.
    pub low: f32,
    /// Newest sample.
    pub newest: f32,
    /// Upper bound.
    pub high: f32,
}

impl SpeedInterval {
    /// All three multiplied by a positive factor.
    pub fn scaled(self, by: f32) -> Self {
        Self { low: self.low * by, newest: self.newest * by, high: self.high * by }
    }

    /// The bounds of both intervals together, with this one's newest sample.
    pub fn spanning(self, other: Self) -> Self {
        let low = if other.low < self.low { other.low } else { self.low };
        let high = if other.high > self.high { other.high } else { self.high };
        Self { low, newest: self.newest, high }
    }
}

/// Values of the sensors that are fitted and valid, in the bicycle's axes, zeros and signs.
///
/// One bit per sensor marks it as valid: the bits stay in one register through the control period, where nine options
/// would take nine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measurements {
    valid: u16,
    // Zero where the sensor is not valid.
    pub(super) gyro_rad_s: [f32; 3],
    pub(super) accel_m_s2: [f32; 3],
    pub(super) steer_rad: f32,
    pub(super) steer_rate_rad_s: f32,
    pub(super) front_wheel_m_s: SpeedInterval,
    pub(super) rear_wheel_m_s: SpeedInterval,
    pub(super) rider_torque_nm: f32,
    pub(super) motor_torque_nm: f32,
    pub(super) path: [f32; 2],
    /// Causes of the sensors that are not valid.
    pub causes: Causes,
}

/// Bits of [`Measurements::valid`].
pub(super) const GYRO_VALID: u16 = 1;
pub(super) const ACCEL_VALID: u16 = 1 << 1;
pub(super) const STEER_VALID: u16 = 1 << 2;
pub(super) const STEER_RATE_VALID: u16 = 1 << 3;
pub(super) const FRONT_WHEEL_VALID: u16 = 1 << 4;
pub(super) const REAR_WHEEL_VALID: u16 = 1 << 5;
pub(super) const RIDER_TORQUE_VALID: u16 = 1 << 6;
pub(super) const MOTOR_VALID: u16 = 1 << 7;
pub(super) const PATH_VALID: u16 = 1 << 8;

impl Measurements {
    /// Records the result of a sensor's monitor: returns value and age if valid, adds the cause otherwise.
    #[inline(always)]
    pub(super) fn note<const N: usize>(
        &mut self,
        sensor: u16,
        checked: CheckedSample<N>,
    ) -> Option<([f32; N], u16)> {
        if let Some(cause) = checked.lost {
            self.causes.note(cause, true);
        }
        if checked.value.is_some() {
            self.valid |= sensor;
        }
        checked.value
    }

    fn is_valid(&self, sensor: u16) -> bool {
        self.valid & sensor != 0
    }

    /// Angular velocity of the frame \[rad/s\].
    pub fn gyro_rad_s(&self) -> Option<[f32; 3]> {
        self.is_valid(GYRO_VALID).then_some(self.gyro_rad_s)
    }

    /// Angular velocity of the frame \[rad/s\], zero if not valid.
    pub fn gyro_or_zero_rad_s(&self) -> [f32; 3] {
        self.gyro_rad_s
    }

    /// Specific force \[m/s^2\].
    pub fn accel_m_s2(&self) -> Option<[f32; 3]> {
        self.is_valid(ACCEL_VALID).then_some(self.accel_m_s2)
    }

    /// Steer angle \[rad\].
    pub fn steer_rad(&self) -> Option<f32> {
        self.is_valid(STEER_VALID).then_some(self.steer_rad)
    }

    /// Steer rate \[rad/s\].
    pub fn steer_rate_rad_s(&self) -> Option<f32> {
        self.is_valid(STEER_RATE_VALID).then_some(self.steer_rate_rad_s)
    }

    /// Speed of the front wheel \[m/s\].
    pub fn front_wheel_m_s(&self) -> Option<SpeedInterval> {
        self.is_valid(FRONT_WHEEL_VALID).then_some(self.front_wheel_m_s)
    }

    /// Speed of the rear wheel \[m/s\].
    pub fn rear_wheel_m_s(&self) -> Option<SpeedInterval> {
        self.is_valid(REAR_WHEEL_VALID).then_some(self.rear_wheel_m_s)
    }

    /// The rider's torque \[N m\].
    pub fn rider_torque_nm(&self) -> Option<f32> {
        self.is_valid(RIDER_TORQUE_VALID).then_some(self.rider_torque_nm)
    }

    /// Torque reported by the drive \[N m\].
    pub fn motor_torque_nm(&self) -> Option<f32> {
        self.is_valid(MOTOR_VALID).then_some(self.motor_torque_nm)
    }

    /// Heading error \[rad\] and lateral error \[m\].
    pub fn path(&self) -> Option<[f32; 2]> {
        self.is_valid(PATH_VALID).then_some(self.path)
    }
}
