//! The motion as far as the sensors show it: attitude, rates, accelerations, and how sure that is.
//!
//! Exact kinematics of a bicycle whose rear wheel rolls without slip (`docs/bicycle.md`): the order of
//! turns is yaw, roll, pitch, so roll rate is `wx cos(pitch) + wz sin(pitch)`, and the lateral
//! specific force at a place `up` above and `forward` of the rear contact is
//! `v yaw_rate cos(roll) - g sin(roll) + up wx' + forward wz' + wy (wx forward + wz (radius - up))`.

mod config;
pub mod predict;
mod roll;
pub mod smooth;
mod steer;

pub use config::{EstimateConfig, Place, SOURCES, Source};

use crate::maths::{G, bounded, max, min, rsqrt, sin_cos, sin_cos_within};
use core::hint::cold_path;
use roll::Roll;
use steer::Steer;

/// Largest angular rate \[rad/s\], specific force \[m/s^2\] and speed \[m/s\] that are reckoned with.
const MOST: (f32, f32, f32) = (100.0, 1000.0, 100.0);
/// Lag of what the roll angle is observed by \[s\]: long against the gyro's noise, short against a turn.
const OBSERVED_S: f32 = 0.1;
/// Speed below which the bicycle stands \[m/s\], and above which it balances by riding.
const STANDING_M_S: f32 = 0.05;
const BALANCING_M_S: f32 = 1.5;
/// How long it must stand and be still before the gyros show their bias \[s\], and how far their smoothed rates may
/// wander in that time \[rad/s\]: on a bicycle held by hand they sway by more, one that leans on something by less.
const STILL_S: f32 = 1.0;
const STILL_RAD_S: f32 = 0.003;
/// A gap after which the past is worth nothing \[us\].
const GAP_US: u32 = 100_000;
/// Angle beyond which the fit of the pitch is not trusted \[rad\].
const FITTED_RAD: f32 = 1.2;

/// What is felt in one control period: rear-frame axes, x forward (horizontal when upright), y right, z down.
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
    /// Rear wheel's rate times its radius, positive forward \[m/s\].
    pub speed_m_s: f32,
    /// Time since the step before \[us\].
    pub elapsed_us: u32,
}

/// The motion that follows from it. Always finite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Roll angle, right positive; a quarter turn at most \[rad\].
    pub roll_rad: f32,
    /// Its sine and cosine.
    pub roll_sin_cos: (f32, f32),
    /// Roll rate by [`Source`] \[rad/s\].
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
    /// Roll acceleration, [`EstimateConfig::accel_lag_s`] late \[rad/s^2\].
    pub roll_accel_rad_s2: f32,
    /// By how much the roll angle may be wrong.
    pub roll_error: RollError,
    /// Biases of the gyros, as far as known \[rad/s\].
    pub gyro_bias_rad_s: [f32; 3],
    /// Size of the specific force \[m/s^2\], if it is felt.
    pub force_m_s2: Option<f32>,
}

/// By how much the roll angle may be wrong, in parts from which [`RollError::bound_rad`] is worked out where it is needed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RollError {
    /// Three standard deviations of what averages out, squared \[rad^2\].
    pub square_rad2: f32,
    /// What does not average out \[rad\].
    pub systematic_rad: f32,
}

impl RollError {
    /// Nothing is known.
    pub const UNKNOWN: Self = Self { square_rad2: 0.0, systematic_rad: core::f32::consts::PI };

    /// The roll angle is wrong by no more than this; pi when nothing is known \[rad\].
    pub fn bound_rad(&self) -> f32 {
        bounded(root(self.square_rad2) + self.systematic_rad, core::f32::consts::PI)
    }

    /// Whether the bound is larger than this \[rad\].
    pub fn is_beyond(&self, limit_rad: f32) -> bool {
        let left = limit_rad - self.systematic_rad;
        left < 0.0 || self.square_rad2 > left * left
    }
}

/// What the estimator remembers.
#[derive(Clone, Debug, Default)]
pub struct EstimateState {
    /// `None` before the first step and after a gap.
    running: Option<Running>,
    /// Biases about y and z \[rad/s\], and their standard deviation. They show only while standing still.
    bias: [f32; 2],
    bias_deviation: Option<f32>,
    steer: Steer,
}

#[derive(Clone, Debug)]
struct Running {
    roll: Roll,
    /// The sideways force that is not explained, before lever arms, smoothed \[m/s^2\].
    unexplained_m_s2: f32,
    /// Rates about x and z, smoothed \[rad/s\].
    smooth: [f32; 2],
    /// Roll rate, smoothed for the roll acceleration \[rad/s\].
    roll_rate: f32,
    still_s: f32,
    /// At rest the rates as told, smoothed, now and when it became still \[rad/s\].
    resting: [f32; 3],
    still_at: [f32; 3],
}

impl Running {
    /// Time goes on at rest: it counts while the rates neither are larger than a bias nor wander.
    fn stand(&mut self, (x, y, z): (f32, f32, f32), dt: f32, bias_max: f32) {
        let keep = dt / (OBSERVED_S + dt);
        let mut still = true;
        for ((rate, smooth), at) in [x, y, z].iter().zip(&mut self.resting).zip(&self.still_at) {
            *smooth += keep * (rate - *smooth);
            still &= rate.abs() <= bias_max && (*smooth - at).abs() <= STILL_RAD_S;
        }
        if still {
            self.still_s += dt;
        } else {
            (self.still_s, self.still_at) = (0.0, self.resting);
        }
    }
}

/// One control period.
pub fn step(config: &EstimateConfig, state: &mut EstimateState, input: &EstimatorInput) -> Motion {
    let mut dt = 1e-6 * input.elapsed_us as f32;
    if input.elapsed_us > GAP_US {
        cold_path();
        dt = 1e-6 * GAP_US as f32;
        state.running = None;
        state.steer = Steer::default();
    }
    let c = config;
    let (steer_rad, steer_rate_rad_s) =
        state.steer.step(c.steer_lag_s, dt, input.steer_rad, input.steer_rate_rad_s);
    let speed = bounded(input.speed_m_s, MOST.2);
    let gyro = input.gyro_rad_s.map(|w| bounded(w, MOST.0));
    let at_first = c.bias_max_rad_s / 3.0;
    let mut bias_deviation = state.bias_deviation.unwrap_or(at_first);

    let [by, bz] = state.bias;
    let [wy, wz] = [gyro[1] - by, gyro[2] - bz];
    let run = state.running.get_or_insert_with(|| Running {
        roll: Roll::unknown(c.bias_max_rad_s),
        unexplained_m_s2: 0.0,
        smooth: [gyro[0], wz],
        roll_rate: gyro[0],
        still_s: 0.0,
        resting: [0.0; 3],
        still_at: [0.0; 3],
    });
    let wx = gyro[0] - run.roll.bias_rad_s;
    let pitch_rad = pitch(&c.pitch, run.roll.angle_rad, steer_rad);
    let (sin_pitch, cos_pitch) = sin_cos(pitch_rad);
    let roll_rate = wx * cos_pitch + wz * sin_pitch;
    run.roll.turn(roll_rate, dt, (c.gyro_walk_rad, c.bias_walk_rad_s), c.bias_max_rad_s);
    // The square grows by that of the walk; to first order, which is more.
    let walk = c.bias_walk_rad_s * c.bias_walk_rad_s;
    bias_deviation = min(at_first, bias_deviation + 0.5 * dt * walk / max(1e-5, bias_deviation));

    // At rest the gyros show nothing but their bias.
    if speed.abs() > STANDING_M_S {
        run.still_s = 0.0;
    } else {
        cold_path();
        let [x, y, z] = gyro;
        run.stand((x, y, z), dt, c.bias_max_rad_s);
    }
    if run.still_s > STILL_S {
        run.still_s = 2.0 * STILL_S;
        let observed = c.gyro_walk_rad * c.gyro_walk_rad / max(1e-6, dt);
        let _ = run.roll.observe_bias(wx, observed, c.bias_max_rad_s);
        let variance = bias_deviation * bias_deviation;
        let gain = variance / (variance + observed);
        bias_deviation = root(variance - gain * variance);
        state.bias = [by + gain * wy, bz + gain * wz].map(|b| bounded(b, c.bias_max_rad_s));
    }

    let (sin_roll, cos_roll) = sin_cos_within(run.roll.angle_rad);
    // As if roll were nearer to upright than 72 degrees: the division must not blow up.
    let yaw_rate = (wz * cos_pitch - wx * sin_pitch) / max(0.3, cos_roll);
    // What the rear wheel's contact moves with: its rate seen from the ground.
    let rolling = speed - wy * c.wheel_radius_m;
    let (place, noise, error, force) = match input.accel_m_s2 {
        Some(f) => (&c.imu, c.accel_noise_rad, c.accel_error_rad, f.map(|f| bounded(f, MOST.1))),
        None => (&c.balance, c.balance_noise_rad, c.balance_error_rad, [0.0, 0.0, -G]),
    };
    let swing = wy * (wx * place.forward_m + wz * (c.wheel_radius_m - place.up_m));
    let unexplained = force[1] - rolling * yaw_rate * cos_roll + G * sin_roll - swing;
    let keep = dt / (OBSERVED_S + dt);
    run.unexplained_m_s2 += keep * (unexplained - run.unexplained_m_s2);
    run.smooth = [run.smooth[0] + keep * (wx - run.smooth[0]), run.smooth[1] + keep * (wz - run.smooth[1])];
    let lever = place.up_m * ((wx - run.smooth[0]) / OBSERVED_S)
        + place.forward_m * ((wz - run.smooth[1]) / OBSERVED_S);
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
fn pitch(fit: &[f32; 6], roll_rad: f32, steer_rad: f32) -> f32 {
    let (r, d) = (bounded(roll_rad, FITTED_RAD), bounded(steer_rad, FITTED_RAD));
    let [dd, dr, d4, d3r, d2r2, dr3] = *fit;
    d * (d * dd + r * dr + d * d * (d * d4 + r * d3r) + r * r * (d * d2r2 + r * dr3))
}
