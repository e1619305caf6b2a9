//! Predicts roll angle and rate at the instant at which the torque acts, to compensate the delay of sensors and
//! actuator.
//!
//! Linear extrapolation, `rate + lead * acceleration`, which needs only a gyro. A prediction with the linear bicycle
//! and the torques not yet in effect needs a steer sensor and the bicycle's parameters, and recovers hardly more of the
//! basin (`docs/delay.md`).

use crate::estimate::Motion;
use crate::maths::bounded;
use crate::param::{ParamSpec, ParamVisitor};

/// Parameters of the prediction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictConfig {
    /// Prediction horizon: the delay of sensors and actuator together \[s\]; 0 is off.
    pub lead_s: f32,
    /// Largest change of the roll rate, either way \[rad/s\]: the response of the gyro to an impact is not motion of
    /// the bicycle.
    pub max_rad_s: f32,
}

impl Default for PredictConfig {
    /// Off; at most 1 rad/s, more than the change within 50 ms of any ride that can be saved.
    fn default() -> Self {
        Self { lead_s: 0.0, max_rad_s: 1.0 }
    }
}

impl PredictConfig {
    /// Whether the prediction needs the estimated motion.
    pub fn needs_motion(&self) -> bool {
        self.lead_s > 0.0
    }

    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("predict", "lead_s", 0.0, 0.1), &mut self.lead_s);
        to.number(&ParamSpec::new("predict", "max_rad_s", 0.0, 10.0), &mut self.max_rad_s);
    }
}

/// Predicted roll.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictedMotion {
    /// Angle \[rad\].
    pub roll_rad: f32,
    /// Rate \[rad/s\].
    pub roll_rate_rad_s: f32,
}

/// One control period; returns the input unchanged to the bit when off.
#[inline]
pub fn step(config: &PredictConfig, now: &Motion) -> PredictedMotion {
    let Motion { roll_rad, roll_rate_rad_s, roll_accel_rad_s2, .. } = *now;
    if config.lead_s <= 0.0 {
        return PredictedMotion { roll_rad, roll_rate_rad_s };
    }
    let change_rad_s = bounded(config.lead_s * roll_accel_rad_s2, config.max_rad_s);
    PredictedMotion {
        roll_rad: roll_rad + config.lead_s * roll_rate_rad_s,
        roll_rate_rad_s: roll_rate_rad_s + change_rad_s,
    }
}
