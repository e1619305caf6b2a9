//! The sensors' samples at one control instant.

/// Age that marks a missing sample.
pub const MISSING: u16 = u16::MAX;

/// Newest sample of a sensor, and its age.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Value, in the unit of the field's name. Any bit pattern.
    pub value: f32,
    /// Control periods since the sensor delivered the sample: 0 is fresh, [`MISSING`] is none.
    pub age_ticks: u16,
}

impl Sample {
    /// A sample delivered in this period.
    pub const fn fresh(value: f32) -> Self {
        Self { value, age_ticks: 0 }
    }
    /// No sample.
    pub const fn missing() -> Self {
        Self { value: 0.0, age_ticks: MISSING }
    }
}

/// Newest sample of a sensor with three axes, and its age.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triple {
    /// Values along x, y and z. Any bit patterns.
    pub value: [f32; 3],
    /// Control periods since the sensor delivered the sample: 0 is fresh, [`MISSING`] is none.
    pub age_ticks: u16,
}

impl Triple {
    /// A sample delivered in this period.
    pub const fn fresh(value: [f32; 3]) -> Self {
        Self { value, age_ticks: 0 }
    }
    /// No sample.
    pub const fn missing() -> Self {
        Self { value: [0.0; 3], age_ticks: MISSING }
    }
}

/// The sensors' samples at one control instant, each in the sensor's own axes, zero and sign;
/// [`crate::sensors::calibration`] converts them to the bicycle's. A sensor that is not fitted is always missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorFrame {
    /// Time of this instant \[us\], wrapping.
    pub now_us: u32,
    /// Angular velocity of the rear frame \[rad/s\]: about x (forward, horizontal when upright), y (right) and z
    /// (down). The Euler roll rate of the published laws differs from x by yaw rate times the sine of pitch.
    pub gyro_rad_s: Triple,
    /// Specific force (acceleration less gravity) in the same axes, mean over the last period \[m/s^2\]: (0, 0, -9.81)
    /// upright at rest.
    pub accel_m_s2: Triple,
    /// Steer angle of an absolute sensor \[rad\], positive to the right.
    pub steer_rad: Sample,
    /// Steer rate from the motor's encoder \[rad/s\].
    pub steer_rate_rad_s: Sample,
    /// Rotation rate of the front wheel times its radius \[m/s\], positive forward.
    pub front_wheel_m_s: Sample,
    /// Rotation rate of the rear wheel times its radius \[m/s\], positive forward.
    pub rear_wheel_m_s: Sample,
    /// The rider's torque on the handlebar \[N m\], positive to the right.
    pub rider_torque_nm: Sample,
    /// Torque reported by the drive \[N m\].
    pub motor_torque_nm: Sample,
    /// Heading less the path's direction \[rad\], positive to the right.
    pub heading_error_rad: Sample,
    /// Distance from the path \[m\], positive to its right.
    pub lateral_error_m: Sample,
    /// The rider's switch: true requests assist.
    pub engage: bool,
}

impl SensorFrame {
    /// A frame without any sample, the switch off.
    pub const fn missing() -> Self {
        Self {
            now_us: 0,
            gyro_rad_s: Triple::missing(),
            accel_m_s2: Triple::missing(),
            steer_rad: Sample::missing(),
            steer_rate_rad_s: Sample::missing(),
            front_wheel_m_s: Sample::missing(),
            rear_wheel_m_s: Sample::missing(),
            rider_torque_nm: Sample::missing(),
            motor_torque_nm: Sample::missing(),
            heading_error_rad: Sample::missing(),
            lateral_error_m: Sample::missing(),
            engage: false,
        }
    }
}

/// The wheel whose speed schedules the gains. At large steer angles the front wheel turns up to twice as fast as the
/// rear one, so the two schedules differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wheel {
    /// The front wheel (reproduces the published basins).
    #[default]
    Front,
    /// The rear wheel.
    Rear,
}
