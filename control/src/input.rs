//! May a sensor frame be believed: finite, in range, fresh. Decided before any arithmetic.

use crate::frame::{Sample, SensorFrame, Wheel};
use crate::param::{ParamError, check};

/// What an input must fulfil.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputConfig {
    /// Which wheel [`SensorFrame::wheel_speed_m_s`] is measured on.
    pub wheel: Wheel,
    /// Largest believable roll rate, either way \[rad/s\], 1..=100.
    pub roll_rate_max_rad_s: f32,
    /// Largest believable wheel speed, either way \[m/s\], 1..=30.
    pub speed_max_m_s: f32,
    /// Oldest roll-rate sample that is still used \[control periods\], 0..=1000.
    pub roll_rate_max_age_ticks: u16,
    /// Oldest speed sample that is still used \[control periods\], 0..=1000.
    pub speed_max_age_ticks: u16,
}

impl Default for InputConfig {
    /// Front wheel; 60 rad/s and 30 m/s; only fresh samples.
    fn default() -> Self {
        Self {
            wheel: Wheel::Front,
            roll_rate_max_rad_s: 60.0,
            speed_max_m_s: 30.0,
            roll_rate_max_age_ticks: 0,
            speed_max_age_ticks: 0,
        }
    }
}

/// Why a frame was not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Reject {
    /// No roll rate, or one older than allowed.
    RollRateStale = 1,
    /// Roll rate is NaN, infinite or beyond its range.
    RollRateRange = 2,
    /// No speed, or one older than allowed.
    SpeedStale = 3,
    /// Speed is NaN, infinite or beyond its range.
    SpeedRange = 4,
}

/// A frame's values once believed: finite and in range.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Believed {
    /// Roll rate \[rad/s\].
    pub roll_rate_rad_s: f32,
    /// Wheel speed \[m/s\].
    pub speed_m_s: f32,
}

impl InputConfig {
    /// Checks the limits themselves.
    ///
    /// # Errors
    /// The parameter, its value and the allowed range.
    pub fn validate(&self) -> Result<(), ParamError> {
        check("input.roll_rate_max_rad_s", self.roll_rate_max_rad_s, 1.0, 100.0)?;
        check("input.speed_max_m_s", self.speed_max_m_s, 1.0, 30.0)?;
        let ages = (f32::from(self.roll_rate_max_age_ticks), f32::from(self.speed_max_age_ticks));
        check("input.roll_rate_max_age_ticks", ages.0, 0.0, 1000.0)?;
        check("input.speed_max_age_ticks", ages.1, 0.0, 1000.0)
    }

    /// The values of `frame`, or the first reason not to use it.
    ///
    /// # Errors
    /// A [`Reject`]; the frame must then not reach any arithmetic.
    pub fn believe(&self, frame: &SensorFrame) -> Result<Believed, Reject> {
        let fresh = |s: &Sample, max| s.age_ticks <= max;
        // Written so that NaN, which compares false, is refused.
        let inside = |s: &Sample, max: f32| s.value >= -max && s.value <= max;
        if !fresh(&frame.roll_rate_rad_s, self.roll_rate_max_age_ticks) {
            Err(Reject::RollRateStale)
        } else if !inside(&frame.roll_rate_rad_s, self.roll_rate_max_rad_s) {
            Err(Reject::RollRateRange)
        } else if !fresh(&frame.wheel_speed_m_s, self.speed_max_age_ticks) {
            Err(Reject::SpeedStale)
        } else if !inside(&frame.wheel_speed_m_s, self.speed_max_m_s) {
            Err(Reject::SpeedRange)
        } else {
            Ok(Believed {
                roll_rate_rad_s: frame.roll_rate_rad_s.value,
                speed_m_s: frame.wheel_speed_m_s.value,
            })
        }
    }
}
