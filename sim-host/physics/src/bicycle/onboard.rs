//! The controller's parameters that follow from a bicycle's geometry.

use super::{Geometry, Gyrostat, Motion, State, Torques, pitch_from_upright};
use crate::num::{Dual, sin_cos};
use control::Config;
use control::estimate::{EstimateConfig, Place, Source};
use control::param::{ParamError, ParamSpec, ParamVisitor};
use control::sensors::sign_check::SteerModel;
use nalgebra::{SMatrix, SVector};
use std::sync::{Mutex, PoisonError};

/// Range of the pitch fit: largest magnitudes of roll and steer \[rad\].
const FITTED: (f64, f64) = (0.8, 1.0);
/// Grid points of the fit along each angle.
const POINTS: usize = 41;

/// The estimator's parameters that follow from the bicycle; defaults for the others.
pub fn estimator_parameters(b: &Geometry) -> EstimateConfig {
    EstimateConfig {
        pitch: newest_pitch_fit(b).map(|c| c as f32),
        wheel_radius_m: b.rR as f32,
        balance: balance(b),
        ..EstimateConfig::default()
    }
}

/// Fits the controller's parameters to the bicycle and to the IMU's position `imu_m` from the rear wheel's
/// centre: forward, right, down \[m\]. Other settings stay unchanged. A check that needs a parameter outside
/// its range is switched off, with one line of explanation each in the result. A capsize term, a predictor or
/// a path that needs such an estimate stays on, and the configuration fails its check.
pub fn fit(config: &mut Config, b: &Geometry, imu_m: [f64; 3]) -> Vec<String> {
    let imu = Place { forward_m: imu_m[0] as f32, up_m: (b.rR - imu_m[2]) as f32 };
    let EstimateConfig { pitch, wheel_radius_m, balance, .. } = estimator_parameters(b);
    config.estimate = EstimateConfig { pitch, wheel_radius_m, balance, imu, ..config.estimate };
    (config.cross.wheelbase_m, config.cross.tilt_rad) = (b.w as f32, b.lam as f32);
    config.response.motor = config.response.motor.map(|_| steer_model(b));
    let mut outside = Outside::default();
    config.visit_params(&mut outside);
    let of = |group: &str| outside.0.iter().find(|e| e.leaf.group.starts_with(group)).copied();
    let mut off = Vec::new();
    if let Some(error) = of("response.motor") {
        config.response.motor = None;
        off.push(format!(
            "{error}: the check of the motor's response is off, as by --set response.motor=off"
        ));
    }
    // The default lead of the product may be dropped; a changed one was set on purpose.
    let leads = config.predict.lead_s > 0.0 && config.predict != Config::product().predict;
    let needed = config.capsize.is_on() || leads || config.track.is_some();
    if let (Some(error), false) = (of("estimate"), needed) {
        config.estimate =
            EstimateConfig { roll_rate: config.estimate.roll_rate, ..EstimateConfig::default() };
        let used = switch_estimate_off(config);
        if used {
            off.push(format!(
                "{error}: the motion estimate and all that needs it are off, as by --set estimate.roll_rate=gyro_x, \
                 response.gyro=off, response.motor=off, and none for permit.fallen_rad, permit.roll_unknown_rad, \
                 cross.wheels_m_s, cross.yaw_rad_s and cross.yaw_slow_rad_s, cross.yaw_slope=off, \
                 cross.roll_correlation=off, predict.lead_s=0"
            ));
        }
    }
    off
}

/// Switches off all checks that need the motion estimate; returns whether any was on.
fn switch_estimate_off(config: &mut Config) -> bool {
    let before = config.clone();
    config.estimate.roll_rate = Source::GyroX;
    (config.response.gyro, config.response.motor) = (false, None);
    (config.permit.fallen_rad, config.permit.roll_unknown_rad) = (None, None);
    let cross = &mut config.cross;
    (cross.wheels_m_s, cross.yaw_rad_s, cross.yaw_slow_rad_s, cross.yaw_slope) = (None, None, None, false);
    cross.roll_correlation = false;
    config.predict.lead_s = 0.0;
    *config != before
}

/// Collects the numbers outside their ranges.
#[derive(Default)]
struct Outside(Vec<ParamError>);

impl ParamVisitor for Outside {
    fn number(&mut self, leaf: &ParamSpec, value: &mut f32) {
        self.0.extend(leaf.check(*value).err());
    }
    fn optional_number(&mut self, _: &ParamSpec, _: &mut Option<f32>) {}
    fn count(&mut self, _: &ParamSpec, _: &mut u16) {}
    fn switch(&mut self, _: &ParamSpec, _: &mut bool) {}
    fn choice(&mut self, _: &ParamSpec, _: &'static [&'static str], _: &mut u8) {}
}

/// Linear model of the steer acceleration near straight upright riding: exact derivatives of the nonlinear
/// equations.
pub fn steer_model(b: &Geometry) -> SteerModel {
    let constant = |re| Dual { re, eps: 0.0 };
    // Derivative with respect to roll, steer, their rates or the steer torque.
    let by = |input: usize, v: f64| {
        let at = |i: usize| if i == input { Dual::variable(0.0) } else { constant(0.0) };
        let upright = State::upright(b, constant(v));
        let state = State { roll: at(0), steer: at(1), roll_rate: at(2), steer_rate: at(3), ..upright };
        let torques = Torques { roll: constant(0.0), steer: at(4) };
        Motion::new(b, &state).accelerations(b, &torques).steer.eps as f32
    };
    let (roll, steer) = (by(0, 0.0), by(1, 0.0));
    SteerModel {
        per_nm: by(4, 0.0),
        roll_rate: by(2, 1.0),
        steer_rate: by(3, 1.0),
        roll,
        steer,
        roll_v2: by(0, 1.0) - roll,
        steer_v2: by(1, 1.0) - steer,
    }
}

/// Terms of [`EstimateConfig::pitch`] at an attitude.
fn terms(roll: f64, steer: f64) -> [f64; 6] {
    let (r, d) = (roll, steer);
    [d * d, d * r, d.powi(4), d.powi(3) * r, (d * r).powi(2), d * r.powi(3)]
}

/// [`pitch_fit`], with the latest bicycle's result cached: the cells of a sweep share it, and it takes 20 ms.
fn newest_pitch_fit(b: &Geometry) -> [f64; 6] {
    static NEWEST: Mutex<Option<(Geometry, [f64; 6])>> = Mutex::new(None);
    let mut newest = NEWEST.lock().unwrap_or_else(PoisonError::into_inner);
    match &*newest {
        Some((bicycle, fit)) if bicycle == b => *fit,
        _ => newest.insert((*b, pitch_fit(b))).1,
    }
}

/// Least-squares fit over a grid of attitudes, without those that have no pitch.
fn pitch_fit(b: &Geometry) -> [f64; 6] {
    let mut normal = SMatrix::<f64, 6, 6>::zeros();
    let mut right = SVector::<f64, 6>::zeros();
    let part = |i: usize| 2.0 * i as f64 / (POINTS - 1) as f64 - 1.0;
    for i in 0..POINTS {
        for j in 0..POINTS {
            let (roll, steer) = (FITTED.0 * part(i), FITTED.1 * part(j));
            if let Some(pitch) = pitch_from_upright(b, roll, steer) {
                let row = SVector::from(terms(roll, steer));
                normal += row * row.transpose();
                right += row * pitch;
            }
        }
    }
    normal.lu().solve(&right).map_or([0.0; 6], Into::into)
}

/// The point of the upright bicycle without lateral specific force, as lateral forces act only at the contacts:
/// `v yaw' + (ITxx roll'' + ITxz yaw'') / (mT hT) = g roll` (Meijaard et al. 2007, eq. A6, without the
/// steer's own terms).
fn balance(b: &Geometry) -> Place {
    let (s, c) = sin_cos(b.lam);
    let mut sums = [0.0; 3];
    let mut add = |body: &Gyrostat, forward: f64| {
        let [along, down] = [body.com[0] + forward, body.com[1]];
        // From steer-axis directions to the frame's, and from the axle to the contact.
        let (x, z) = (along * c + down * s, down * c - along * s - b.rR);
        let [i11, _, i33, i13] = body.inertia;
        let xx = i11 * c * c + 2.0 * i13 * s * c + i33 * s * s;
        let xz = (i33 - i11) * s * c + i13 * (c * c - s * s);
        sums[0] -= body.mass * z;
        sums[1] += xx + body.mass * z * z;
        sums[2] += xz - body.mass * x * z;
    };
    add(&b.rear, 0.0);
    add(&b.front, b.d1);
    let [moment, xx, xz] = sums;
    Place { forward_m: (xz / moment) as f32, up_m: (xx / moment) as f32 }
}
