//! Estimates the bicycle's motion from the sensors: attitude, rates, accelerations, and the error of the roll angle.
//!
//! Exact kinematics of a bicycle whose rear wheel rolls without slip (`docs/bicycle.md`). The order of rotations is
//! yaw, roll, pitch, so roll rate is `wx cos(pitch) + wz sin(pitch)`. The lateral specific force at a point `up` above
//! and `forward` of the rear contact is
//! `v yaw_rate cos(roll) - g sin(roll) + up wx' + forward wz' + wy (wx forward + wz (radius - up))`.

mod config;
pub mod predict;
mod roll;
pub mod smooth;
mod steer;

pub use config::{EstimateConfig, Place, SOURCES, Source};

use crate::maths::{G, bounded, max, min, rsqrt, sin_cos, sin_cos_within};
use core::hint::cold_path;
pub use roll::MAX_INNOVATION_RAD;
use roll::Roll;
use steer::Steer;

/// Limits of the input: angular rate \[rad/s\], specific force \[m/s^2\] and speed \[m/s\].
const INPUT_LIMITS: (f32, f32, f32) = (100.0, 1000.0, 100.0);
/// Lag of the observation of the roll angle \[s\]: long enough to average the gyro's noise, short compared with a turn.
pub const OBSERVATION_LAG_S: f32 = 0.1;
/// Speed below which the bicycle stands, and above which it balances by riding \[m/s\].
const STANDING_M_S: f32 = 0.05;
const BALANCING_M_S: f32 = 1.5;
/// Time at rest after which the gyros' reading is their bias \[s\], and largest change of the smoothed rates in that
/// time \[rad/s\]. A bicycle held by hand sways more, one leaning on an object less.
const REST_S: f32 = 1.0;
const REST_DRIFT_RAD_S: f32 = 0.003;
/// Gap between two steps after which the state is discarded \[us\].
const MAX_GAP_US: u32 = 100_000;
/// Limit of the roll and steer angles in the pitch polynomial \[rad\], whose fit does not reach beyond.
const PITCH_FIT_RAD: f32 = 1.2;

/// Measurements of one control period, in rear-frame axes: x forward (horizontal when upright), y right, z down.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EstimatorInput {
    /// Angular rates about x, y and z \[rad/s\].
    pub gyro_rad_s: [f32; 3],
    /// Specific force, the mean over the last period: (0, 0, -9.81) upright and still \[m/s^2\].
    pub accel_m_s2: Option<[f32; 3]>,
    /// Steer angle, right positive \[rad\].
    pub steer_rad: Option<f32>,
    /// Steer rate \[rad/s\].
    pub steer_rate_rad_s: Option<f32>,
    /// Rotation rate of the rear wheel times its radius, positive forward \[m/s\].
    pub speed_m_s: f32,
    /// Time since the previous step \[us\].
    pub elapsed_us: u32,
}

/// Estimated motion. Always finite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Roll angle, right positive, within a quarter turn \[rad\].
    pub roll_rad: f32,
    /// Sine and cosine of the roll angle.
    pub roll_sin_cos: (f32, f32),
    /// Roll rate from the chosen [`Source`] \[rad/s\].
    pub roll_rate_rad_s: f32,
    /// Yaw rate \[rad/s\].
    pub yaw_rate_rad_s: f32,
    /// Pitch, nose up positive \[rad\]; 0 without a steer sensor.
    pub pitch_rad: f32,
    /// Steer angle \[rad\]; 0 without a sensor.
    pub steer_rad: f32,
    /// Steer rate \[rad/s\]; 0 without a sensor.
    pub steer_rate_rad_s: f32,
    /// Rear wheel's forward speed \[m/s\].
    pub speed_m_s: f32,
    /// Roll acceleration, delayed by [`EstimateConfig::accel_lag_s`] \[rad/s^2\].
    pub roll_accel_rad_s2: f32,
    /// Error of the roll angle.
    pub roll_error: RollError,
    /// Estimated biases of the gyros \[rad/s\].
    pub gyro_bias_rad_s: [f32; 3],
    /// Magnitude of the specific force, if measured \[m/s^2\].
    pub force_m_s2: Option<f32>,
}

/// Error of the roll angle, in parts from which [`RollError::bound_rad`] is computed only where needed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct RollError {
    /// Random part: three standard deviations, squared \[rad^2\].
    pub square_rad2: f32,
    /// Systematic part \[rad\].
    pub systematic_rad: f32,
}

impl RollError {
    /// The roll angle is unknown.
    pub const UNKNOWN: Self = Self { square_rad2: 0.0, systematic_rad: core::f32::consts::PI };

    /// Bound of the error; pi if the roll angle is unknown \[rad\].
    pub fn bound_rad(&self) -> f32 {
        bounded(root(self.square_rad2) + self.systematic_rad, core::f32::consts::PI)
    }

    /// Whether the bound exceeds `limit_rad` \[rad\].
    pub fn is_beyond(&self, limit_rad: f32) -> bool {
        let left = limit_rad - self.systematic_rad;
        left < 0.0 || self.square_rad2 > left * left
    }
}

/// State of the estimator.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct EstimateState {
    /// `None` before the first step and after a gap.
    running: Option<Running>,
    /// Biases about y and z \[rad/s\], and their standard deviation. They are observable only at rest.
    bias: [f32; 2],
    bias_deviation: Option<f32>,
    steer: Steer,
}

/// What changes in the estimator while the bicycle is ridden.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RidingState {
    /// Roll angle \[rad\].
    pub roll_rad: f32,
    /// Biases of the gyros \[rad/s\].
    pub bias_rad_s: [f32; 3],
    /// Variance of the roll angle, covariance, variance of the roll gyro's bias.
    pub covariance: [f32; 3],
    /// Unexplained lateral force before lever arm terms, smoothed \[m/s^2\].
    pub unexplained_m_s2: f32,
    /// Rates about x and z, smoothed \[rad/s\].
    pub smooth_rad_s: [f32; 2],
    /// Roll rate, smoothed for the roll acceleration \[rad/s\].
    pub slow_rad_s: f32,
}

impl EstimateState {
    /// The state of a bicycle that is ridden; `None` before the first step.
    pub fn riding(&self) -> Option<RidingState> {
        let run = self.running.as_ref()?;
        let [y, z] = self.bias;
        Some(RidingState {
            roll_rad: run.roll.angle_rad,
            bias_rad_s: [run.roll.bias_rad_s, y, z],
            covariance: run.roll.covariance(),
            unexplained_m_s2: run.unexplained_m_s2,
            smooth_rad_s: run.smooth,
            slow_rad_s: run.roll_rate,
        })
    }
}

#[derive(Clone, Debug)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
struct Running {
    roll: Roll,
    /// Unexplained lateral force before lever arm terms, smoothed \[m/s^2\].
    unexplained_m_s2: f32,
    /// Rates about x and z, smoothed \[rad/s\].
    smooth: [f32; 2],
    /// Roll rate, smoothed for the roll acceleration \[rad/s\].
    roll_rate: f32,
    rest_s: f32,
    /// At rest: the measured rates, smoothed, now and at the start of the rest \[rad/s\].
    rest_rates: [f32; 3],
    rest_start_rates: [f32; 3],
}

impl Running {
    /// One step at rest: the rest time grows while no rate exceeds the largest bias or drifts.
    fn step_at_rest(&mut self, (x, y, z): (f32, f32, f32), dt: f32, bias_max: f32) {
        let weight = dt / (OBSERVATION_LAG_S + dt);
        let mut at_rest = true;
        for ((rate, smooth), at) in [x, y, z].iter().zip(&mut self.rest_rates).zip(&self.rest_start_rates) {
            *smooth += weight * (rate - *smooth);
            at_rest &= rate.abs() <= bias_max && (*smooth - at).abs() <= REST_DRIFT_RAD_S;
        }
        if at_rest {
            self.rest_s += dt;
        } else {
            (self.rest_s, self.rest_start_rates) = (0.0, self.rest_rates);
        }
    }
}

/// One control period.
pub fn step(config: &EstimateConfig, state: &mut EstimateState, input: &EstimatorInput) -> Motion {
    let mut dt = 1e-6 * input.elapsed_us as f32;
    if input.elapsed_us > MAX_GAP_US {
        cold_path();
        dt = 1e-6 * MAX_GAP_US as f32;
        state.running = None;
        state.steer = Steer::default();
    }
    let c = config;
    let (steer_rad, steer_rate_rad_s) =
        state.steer.step(c.steer_lag_s, dt, input.steer_rad, input.steer_rate_rad_s);
    let speed = bounded(input.speed_m_s, INPUT_LIMITS.2);
    let gyro = input.gyro_rad_s.map(|w| bounded(w, INPUT_LIMITS.0));
    let initial_deviation = c.bias_max_rad_s / 3.0;
    let mut bias_deviation = state.bias_deviation.unwrap_or(initial_deviation);

    let [by, bz] = state.bias;
    let [wy, wz] = [gyro[1] - by, gyro[2] - bz];
    let run = state.running.get_or_insert_with(|| Running {
        roll: Roll::unknown(c.bias_max_rad_s),
        unexplained_m_s2: 0.0,
        smooth: [gyro[0], wz],
        roll_rate: gyro[0],
        rest_s: 0.0,
        rest_rates: [0.0; 3],
        rest_start_rates: [0.0; 3],
    });
    let wx = gyro[0] - run.roll.bias_rad_s;
    let pitch_rad = pitch(&c.pitch, run.roll.angle_rad, steer_rad);
    let (sin_pitch, cos_pitch) = sin_cos(pitch_rad);
    let roll_rate = wx * cos_pitch + wz * sin_pitch;
    run.roll.integrate(roll_rate, dt, (c.gyro_walk_rad, c.bias_walk_rad_s), c.bias_max_rad_s);
    // The variance grows by that of the random walk; the first-order expression is an upper bound.
    let walk = c.bias_walk_rad_s * c.bias_walk_rad_s;
    bias_deviation = min(initial_deviation, bias_deviation + 0.5 * dt * walk / max(1e-5, bias_deviation));

    // At rest the gyros' reading is their bias.
    if speed.abs() > STANDING_M_S {
        run.rest_s = 0.0;
    } else {
        cold_path();
        let [x, y, z] = gyro;
        run.step_at_rest((x, y, z), dt, c.bias_max_rad_s);
    }
    if run.rest_s > REST_S {
        run.rest_s = 2.0 * REST_S;
        let observed = c.gyro_walk_rad * c.gyro_walk_rad / max(1e-6, dt);
        run.roll.observe_bias(wx, observed, c.bias_max_rad_s);
        let variance = bias_deviation * bias_deviation;
        let gain = variance / (variance + observed);
        bias_deviation = root(variance - gain * variance);
        state.bias = [by + gain * wy, bz + gain * wz].map(|b| bounded(b, c.bias_max_rad_s));
    }

    let (sin_roll, cos_roll) = sin_cos_within(run.roll.angle_rad);
    // The roll angle is limited to 72 degrees here, so that the division stays bounded.
    let yaw_rate = (wz * cos_pitch - wx * sin_pitch) / max(0.3, cos_roll);
    // Speed of the rear contact point: wheel rotation relative to the ground.
    let rolling = speed - wy * c.wheel_radius_m;
    let (place, noise, error, force) = match input.accel_m_s2 {
        Some(f) => (&c.imu, c.accel_noise_rad, c.accel_error_rad, f.map(|f| bounded(f, INPUT_LIMITS.1))),
        None => (&c.balance, c.balance_noise_rad, c.balance_error_rad, [0.0, 0.0, -G]),
    };
    let swing = wy * (wx * place.forward_m + wz * (c.wheel_radius_m - place.up_m));
    let unexplained = force[1] - rolling * yaw_rate * cos_roll + G * sin_roll - swing;
    let weight = dt / (OBSERVATION_LAG_S + dt);
    run.unexplained_m_s2 += weight * (unexplained - run.unexplained_m_s2);
    run.smooth =
        [run.smooth[0] + weight * (wx - run.smooth[0]), run.smooth[1] + weight * (wz - run.smooth[1])];
    let lever = place.up_m * ((wx - run.smooth[0]) / OBSERVATION_LAG_S)
        + place.forward_m * ((wz - run.smooth[1]) / OBSERVATION_LAG_S);
    let observed = input.accel_m_s2.is_some() || speed >= BALANCING_M_S;
    let force_m_s2 = input.accel_m_s2.map(|_| size(force));
    if observed && dt > 0.0 {
        let pull = force_m_s2.unwrap_or(G) - G;
        let violence = (lever * lever + pull * pull) / (c.violent_m_s2 * c.violent_m_s2);
        let variance = noise * noise * (1.0 + violence) / dt;
        run.roll.observe((lever - run.unexplained_m_s2) / G, variance, c.bias_max_rad_s);
    }

    run.roll_rate += dt / (c.accel_lag_s + dt) * (roll_rate - run.roll_rate);
    let roll_accel_rad_s2 = (roll_rate - run.roll_rate) / c.accel_lag_s;
    let yaw_error = 3.0 * bias_deviation + c.speed_error * yaw_rate.abs();
    let systematic = error + speed.abs() * yaw_error / G;
    let roll_error = RollError { square_rad2: run.roll.spread(), systematic_rad: systematic };
    state.bias_deviation = Some(bias_deviation);
    let gyro_x = input.gyro_rad_s[0];
    Motion {
        roll_rad: run.roll.angle_rad,
        roll_sin_cos: (sin_roll, cos_roll),
        roll_rate_rad_s: match c.roll_rate {
            Source::GyroX => bounded(gyro_x, f32::MAX),
            Source::Estimate => roll_rate,
        },
        yaw_rate_rad_s: yaw_rate,
        pitch_rad,
        steer_rad,
        steer_rate_rad_s,
        speed_m_s: speed,
        roll_accel_rad_s2,
        roll_error,
        gyro_bias_rad_s: [run.roll.bias_rad_s, state.bias[0], state.bias[1]],
        force_m_s2,
    }
}

/// Length of a vector.
pub(crate) fn size([x, y, z]: [f32; 3]) -> f32 {
    root(x * x + y * y + z * z)
}

/// Square root of a number that is known to be neither negative nor infinite nor NaN.
fn root(square: f32) -> f32 {
    square * rsqrt(square)
}

/// Pitch by the fitted polynomial \[rad\].
pub fn pitch(fit: &[f32; 6], roll_rad: f32, steer_rad: f32) -> f32 {
    let (r, d) = (bounded(roll_rad, PITCH_FIT_RAD), bounded(steer_rad, PITCH_FIT_RAD));
    let [dd, dr, d4, d3r, d2r2, dr3] = *fit;
    d * (d * dd + r * dr + d * d * (d * d4 + r * d3r) + r * r * (d * d2r2 + r * dr3))
}
