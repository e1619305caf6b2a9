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

/// The sensors at one control instant, benchmark axes and signs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorFrame {
    /// Angular rate of the rear frame about its x axis (forward, horizontal when upright), as a
    /// gyro on the frame gives it \[rad/s\]; positive rolling right. The Euler rate of roll that
    /// the published laws use differs from it by yaw rate times the sine of pitch and mounting.
    pub roll_rate_rad_s: Sample,
    /// Forward speed of the wheel named in [`crate::InputConfig::wheel`] \[m/s\]: its rate times
    /// its radius, positive forward.
    pub wheel_speed_m_s: Sample,
}

impl SensorFrame {
    /// A frame with no sample in it.
    pub const fn missing() -> Self {
        Self { roll_rate_rad_s: Sample::missing(), wheel_speed_m_s: Sample::missing() }
    }
}

/// Which wheel the speed sensor sits on. At large steer angles the front wheel turns up to twice
/// as fast as the rear one, so a gain scheduled with one is not the gain scheduled with the other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wheel {
    /// The front wheel (what reproduces the published basins).
    #[default]
    Front,
    /// The rear wheel.
    Rear,
}
