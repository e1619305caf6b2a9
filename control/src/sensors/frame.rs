//! What the sensors say at one control instant.

/// Age that stands for "no sample at all".
pub const MISSING: u16 = u16::MAX;

/// One sensor's newest sample and how old it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The value, in the unit the field's name says. Any bit pattern.
    pub value: f32,
    /// Control periods since the sensor delivered it: 0 is fresh, [`MISSING`] is none.
    pub age_ticks: u16,
}

impl Sample {
    /// A sample delivered in this very period.
    pub const fn fresh(value: f32) -> Self {
        Self { value, age_ticks: 0 }
    }
    /// No sample.
    pub const fn missing() -> Self {
        Self { value: 0.0, age_ticks: MISSING }
    }
}

/// The newest sample of a sensor with three axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triple {
    /// The values along x, y and z. Any bit patterns.
    pub value: [f32; 3],
    /// Control periods since the sensor delivered them: 0 is fresh, [`MISSING`] is none.
    pub age_ticks: u16,
}

impl Triple {
    /// A sample delivered in this very period.
    pub const fn fresh(value: [f32; 3]) -> Self {
        Self { value, age_ticks: 0 }
    }
    /// No sample.
    pub const fn missing() -> Self {
        Self { value: [0.0; 3], age_ticks: MISSING }
    }
}

/// The sensors at one control instant, each in its own axes, zero and sign, which
/// [`crate::sensors::calibration`] turns into the bicycle's. A sensor that is not there is always missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorFrame {
    /// The time of this instant \[us\], wrapping.
    pub now_us: u32,
    /// Angular velocity of the rear frame \[rad/s\]: about x (forward, horizontal when upright), y
    /// (right) and z (down). The Euler rate of roll that the published laws use differs from x by
    /// yaw rate times the sine of pitch.
    pub gyro_rad_s: Triple,
    /// Specific force, acceleration less gravity, in the same axes \[m/s^2\]: (0, 0, -9.81) upright
    /// at rest. The mean over the last period.
    pub accel_m_s2: Triple,
    /// Steer angle by a sensor that knows its zero \[rad\], positive to the right.
    pub steer_rad: Sample,
    /// Steer rate by the motor's encoder \[rad/s\].
    pub steer_rate_rad_s: Sample,
    /// Rate of the front wheel times its radius \[m/s\], positive forward.
    pub front_wheel_m_s: Sample,
    /// Rate of the rear wheel times its radius \[m/s\], positive forward.
    pub rear_wheel_m_s: Sample,
    /// The rider's torque on the handlebar \[N m\], positive to the right.
    pub rider_torque_nm: Sample,
    /// The torque that the drive says it gives \[N m\].
    pub motor_torque_nm: Sample,
    /// Heading less the path's direction \[rad\], positive to the right.
    pub heading_error_rad: Sample,
    /// Distance from the path \[m\], positive to its right.
    pub lateral_error_m: Sample,
    /// The rider's switch: true asks for assist.
    pub engage: bool,
}

impl SensorFrame {
    /// A frame with no sample in it, the switch off.
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

/// Which wheel's speed schedules the gains. At large steer angles the front wheel turns up to twice
/// as fast as the rear one, so a gain scheduled with one is not the gain scheduled with the other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wheel {
    /// The front wheel (what reproduces the published basins).
    #[default]
    Front,
    /// The rear wheel.
    Rear,
}
