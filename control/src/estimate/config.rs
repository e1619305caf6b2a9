//! Parameters of the estimator: the bicycle and its sensors.

use crate::param::{ParamSpec, ParamVisitor};

/// Source of the roll rate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Source {
    /// The gyro's x axis, unchanged to the bit: the published conditions, where it is the roll rate.
    #[default]
    GyroX = 0,
    /// The Euler roll rate: corrected for pitch and gyro bias.
    Estimate = 1,
}

/// Names of the values of [`Source`].
pub const SOURCES: &[&str] = &["gyro_x", "estimate"];

/// A point in the rear frame's plane, upright, relative to the rear wheel's contact point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Forward of the contact point \[m\].
    pub forward_m: f32,
    /// Above the ground \[m\].
    pub up_m: f32,
}

/// Parameters of the estimator.
///
/// Pitch is
/// `steer * (pitch[0] steer + pitch[1] roll + pitch[2] steer^3 + pitch[3] steer^2 roll + pitch[4] steer roll^2 + pitch[5] roll^3)`:
/// zero with a straight wheel, equal for mirrored attitudes. The host fits the coefficients to the bicycle's geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimateConfig {
    /// Source of the roll rate.
    pub roll_rate: Source,
    /// Coefficients of the pitch polynomial \[rad\].
    pub pitch: [f32; 6],
    /// Rear wheel radius \[m\].
    pub wheel_radius_m: f32,
    /// Position of the accelerometer.
    pub imu: Place,
    /// Position on the bicycle with its rigid rider at which the lateral specific force is zero: at the height of the
    /// centre of percussion for an impact at ground level. Zero, the reading of an accelerometer there, replaces a
    /// missing accelerometer.
    pub balance: Place,
    /// Largest gyro bias of any axis \[rad/s\].
    pub bias_max_rad_s: f32,
    /// Random walk of a gyro bias: standard deviation after one second \[rad/s\].
    pub bias_walk_rad_s: f32,
    /// Angle random walk of the gyro: standard deviation of the angle after one second \[rad\].
    pub gyro_walk_rad: f32,
    /// Noise of the roll angle from one second of accelerometer samples: standard deviation \[rad\].
    pub accel_noise_rad: f32,
    /// Systematic error of the accelerometer's roll angle: mounting, offset, tyres \[rad of roll\].
    pub accel_error_rad: f32,
    /// As `accel_noise_rad`, without an accelerometer.
    pub balance_noise_rad: f32,
    /// As `accel_error_rad`, without an accelerometer: a rider who leans out of the frame's plane.
    pub balance_error_rad: f32,
    /// Relative error of the speed.
    pub speed_error: f32,
    /// Acceleration, relative to steady riding, at which an observation has half its weight \[m/s^2\].
    pub violent_m_s2: f32,
    /// Lag of the steer rate derived from the steer angle \[s\].
    pub steer_lag_s: f32,
    /// Lag of the roll acceleration \[s\].
    pub accel_lag_s: f32,
}

impl Default for EstimateConfig {
    /// Roll rate from the gyro's x axis; a city bicycle with its IMU at the saddle; consumer sensors.
    fn default() -> Self {
        Self {
            roll_rate: Source::GyroX,
            pitch: [0.0; 6],
            wheel_radius_m: 0.35,
            imu: Place { forward_m: 0.3, up_m: 0.8 },
            balance: Place { forward_m: 0.45, up_m: 1.2 },
            bias_max_rad_s: 0.06,
            bias_walk_rad_s: 2e-4,
            gyro_walk_rad: 6e-3,
            accel_noise_rad: 0.02,
            accel_error_rad: 0.03,
            balance_noise_rad: 0.05,
            balance_error_rad: 0.1,
            speed_error: 0.03,
            violent_m_s2: 3.0,
            steer_lag_s: 0.01,
            accel_lag_s: 0.03,
        }
    }
}

impl EstimateConfig {
    /// Whether the law takes its roll rate from the estimated motion.
    pub fn needs_motion(&self) -> bool {
        self.roll_rate == Source::Estimate
    }

    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        let own = |name, min, max| ParamSpec::new("estimate", name, min, max);
        let mut source = self.roll_rate as u8;
        to.choice(&own("roll_rate", 0.0, 1.0), SOURCES, &mut source);
        self.roll_rate = if source == Source::Estimate as u8 { Source::Estimate } else { Source::GyroX };
        let terms = ["steer2", "steer_roll", "steer4", "steer3_roll", "steer2_roll2", "steer_roll3"];
        for (name, value) in terms.into_iter().zip(&mut self.pitch) {
            to.number(&ParamSpec::new("estimate.pitch", name, -1.0, 1.0), value);
        }
        to.number(&own("wheel_radius_m", 0.02, 1.5), &mut self.wheel_radius_m);
        for (group, place) in [("estimate.imu", &mut self.imu), ("estimate.balance", &mut self.balance)] {
            to.number(&ParamSpec::new(group, "forward_m", -2.0, 3.0), &mut place.forward_m);
            to.number(&ParamSpec::new(group, "up_m", 0.0, 3.0), &mut place.up_m);
        }
        to.number(&own("bias_max_rad_s", 1e-3, 1.0), &mut self.bias_max_rad_s);
        to.number(&own("bias_walk_rad_s", 1e-6, 0.1), &mut self.bias_walk_rad_s);
        to.number(&own("gyro_walk_rad", 1e-5, 0.1), &mut self.gyro_walk_rad);
        to.number(&own("accel_noise_rad", 1e-3, 1.0), &mut self.accel_noise_rad);
        to.number(&own("accel_error_rad", 0.0, 1.0), &mut self.accel_error_rad);
        to.number(&own("balance_noise_rad", 1e-3, 1.0), &mut self.balance_noise_rad);
        to.number(&own("balance_error_rad", 0.0, 1.0), &mut self.balance_error_rad);
        to.number(&own("speed_error", 0.0, 0.5), &mut self.speed_error);
        to.number(&own("violent_m_s2", 0.1, 100.0), &mut self.violent_m_s2);
        to.number(&own("steer_lag_s", 1e-3, 0.5), &mut self.steer_lag_s);
        to.number(&own("accel_lag_s", 1e-3, 0.5), &mut self.accel_lag_s);
    }
}
