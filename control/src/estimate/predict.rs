//! What the roll will be when the torque acts: sensors and actuator are late, the bicycle is not.
//!
//! A straight line ahead, `rate + lead * acceleration`. It needs a gyro and nothing else. The linear
//! bicycle with the torques still on their way, which needs a steer sensor and the bicycle's
//! parameters, wins back hardly more of the basin (`docs/delay.md`).

use crate::estimate::Motion;
use crate::maths::bounded;
use crate::param::{ParamSpec, ParamVisitor};

/// How the delay is made up for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictConfig {
    /// How far ahead: the delay of sensors and actuator together \[s\]; 0 is off.
    pub lead_s: f32,
    /// Most that is added to the roll rate, either way \[rad/s\]: a blow that the gyro feels is no
    /// motion of the bicycle.
    pub max_rad_s: f32,
}

impl Default for PredictConfig {
    /// Off; 1 rad/s, which 50 ms ahead is beyond any ride that can be saved.
    fn default() -> Self {
        Self { lead_s: 0.0, max_rad_s: 1.0 }
    }
}

impl PredictConfig {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.number(&ParamSpec::new("predict", "lead_s", 0.0, 0.1), &mut self.lead_s);
        to.number(&ParamSpec::new("predict", "max_rad_s", 0.0, 10.0), &mut self.max_rad_s);
    }
}

/// The roll as it will be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictedMotion {
    /// Angle \[rad\].
    pub roll_rad: f32,
    /// Rate \[rad/s\].
    pub roll_rate_rad_s: f32,
}

/// One control period; unchanged bits when off.
#[inline]
pub fn step(config: &PredictConfig, now: &Motion) -> PredictedMotion {
    let Motion { roll_rad, roll_rate_rad_s, roll_accel_rad_s2, .. } = *now;
    if config.lead_s <= 0.0 {
        return PredictedMotion { roll_rad, roll_rate_rad_s };
    }
    let more = bounded(config.lead_s * roll_accel_rad_s2, config.max_rad_s);
    PredictedMotion {
        roll_rad: roll_rad + config.lead_s * roll_rate_rad_s,
        roll_rate_rad_s: roll_rate_rad_s + more,
    }
}
