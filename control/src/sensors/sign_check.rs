//! Online sign check: compares the measured effect of gyro and motor with the predicted one.
//!
//! * **Gyro**: at the IMU's position the lateral specific force changes with the rates (`docs/bicycle.md`):
//!   `f_y = v wz - g roll + up wx' + forward wz' + wy (wx forward + wz (radius - up))`. The measured force less the
//!   terms of `wz` is compared with the terms of `wx`.
//! * **Motor**: the steer acceleration less the part explained by the linearised bicycle (Meijaard et al. 2007, eq.
//!   5.3) is compared with the acceleration caused by the drive's torque, as reported or else as requested. A rider's
//!   torque is not known, but muscles are slow. Below walking speed hands hold the handlebar and tyres scrub, which
//!   resembles a reversed motor: there is no check at that speed.
//!
//! The minimum excitations are from rides inside the basins of `h`, without and with riders. There the gyro's slope
//! stays above 0.75, or 0.3 with the noise of a real bicycle, and the motor's above 0. In small motions a rider can
//! push the other way as quickly as the motor does.

use crate::estimate::{EstimateConfig, Motion, Place};
use crate::fault::{Cause, Causes};
use crate::maths::G;
use crate::param::{ParamSpec, ParamVisitor, optional};
use crate::sensors::cross_check::RIDING_M_S;
use crate::sensors::measurements::Measurements;
use crate::sensors::regression::{BLOCK_S, BlockMean, Slope, SlopeConfig, SlopePlan};
use core::hint::cold_path;

/// Length of a gyro block in motor blocks: long enough that the apparent acceleration of a noisy gyro sampled at 100 Hz
/// is small.
const GYRO_BLOCKS: u16 = 6;

/// Lateral specific force \[m/s^2\].
const GYRO: SlopeConfig =
    SlopeConfig { highpass_s: 0.3, forget_s: 0.4, max_measured: 20.0, min_excitation: 0.2, settle_s: 0.05 };
/// Slope below which the gyro is wrong. A reversed x axis gives about -1, a reversed z axis less; an impact that turns
/// the frame at once, which the lateral force does not show, up to -0.2 for a moment.
pub const GYRO_WRONG: f32 = -0.4;

/// Steer acceleration \[rad/s^2\].
const MOTOR: SlopeConfig =
    SlopeConfig { highpass_s: 0.05, forget_s: 0.2, max_measured: 60.0, min_excitation: 5.0, settle_s: 0.05 };
/// Slope below which the motor is wrong.
pub const MOTOR_WRONG: f32 = -0.2;

/// Selection of the sign checks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SignCheckConfig {
    /// Whether to check the gyro's signs; needs accelerometer and a wheel.
    pub gyro: bool,
    /// Model of the steer acceleration for the motor check; needs gyro, steer angle, steer rate and a wheel. `None` is
    /// no check.
    pub motor: Option<SteerModel>,
}

/// Steer acceleration of the linearised bicycle:
/// `per_nm T + v (roll_rate roll' + steer_rate steer') + (roll + v^2 roll_v2) roll + (steer + v^2 steer_v2) steer`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteerModel {
    /// Per N m of torque \[rad/s^2 / (N m)\].
    pub per_nm: f32,
    /// Per roll rate and speed \[1/m\].
    pub roll_rate: f32,
    /// Per steer rate and speed \[1/m\].
    pub steer_rate: f32,
    /// Per roll angle \[1/s^2\].
    pub roll: f32,
    /// Per steer angle \[1/s^2\].
    pub steer: f32,
    /// Per roll angle and squared speed \[1/m^2\].
    pub roll_v2: f32,
    /// Per steer angle and squared speed \[1/m^2\].
    pub steer_v2: f32,
}

impl Default for SteerModel {
    /// A city bicycle with its rider.
    fn default() -> Self {
        Self {
            per_nm: 5.6,
            roll_rate: 1.75,
            steer_rate: -3.6,
            roll: 19.0,
            steer: 40.0,
            roll_v2: 0.0,
            steer_v2: -2.1,
        }
    }
}

impl SignCheckConfig {
    /// Whether a check needs the estimated motion: that of the motor.
    pub fn needs_motion(&self) -> bool {
        self.motor.is_some()
    }

    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        to.switch(&ParamSpec::switch("response", "gyro"), &mut self.gyro);
        optional(to, &ParamSpec::switch("response", "motor"), &mut self.motor, |m, to| {
            let leaf = |name, min, max| ParamSpec::new("response.motor", name, min, max);
            to.number(&leaf("per_nm", 0.1, 100.0), &mut m.per_nm);
            to.number(&leaf("roll_rate", -100.0, 100.0), &mut m.roll_rate);
            to.number(&leaf("steer_rate", -100.0, 100.0), &mut m.steer_rate);
            to.number(&leaf("roll", -1000.0, 1000.0), &mut m.roll);
            to.number(&leaf("steer", -1000.0, 1000.0), &mut m.steer);
            to.number(&leaf("roll_v2", -100.0, 100.0), &mut m.roll_v2);
            to.number(&leaf("steer_v2", -100.0, 100.0), &mut m.steer_v2);
        });
    }
}

/// Constants derived from the parameters and the call rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignCheckPlan {
    config: SignCheckConfig,
    /// Position of the IMU.
    imu: Place,
    wheel_radius_m: f32,
    /// Control periods of a motor block, and of a gyro block.
    motor_ticks: u16,
    gyro_ticks: u16,
    motor: SlopePlan,
    gyro: SlopePlan,
}

impl SignCheckPlan {
    /// For `rate_hz` calls per second.
    pub fn new(config: &SignCheckConfig, place: &EstimateConfig, rate_hz: f32) -> Self {
        // At most 80 at the highest rate.
        let motor_ticks = ((BLOCK_S * rate_hz) as u16).max(2);
        let dt_s = 1.0 / rate_hz * f32::from(motor_ticks);
        Self {
            config: *config,
            imu: place.imu,
            wheel_radius_m: place.wheel_radius_m,
            motor_ticks,
            gyro_ticks: GYRO_BLOCKS * motor_ticks,
            motor: SlopePlan::new(MOTOR, dt_s),
            gyro: SlopePlan::new(GYRO, f32::from(GYRO_BLOCKS) * dt_s),
        }
    }
}

/// State of the sign check.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "bitcode", derive(bitcode::Encode, bitcode::Decode))]
pub struct SignCheckState {
    gyro_tick: u16,
    motor_tick: u16,
    gyro: BlockMean<5>,
    gyro_slope: Slope,
    /// Expected and measured lateral force of the previous block \[m/s^2\].
    gyro_before: Option<[f32; 2]>,
    /// Whether the slope at the end of the last block was below its threshold.
    gyro_reversed: bool,
    motor: BlockMean<6>,
    motor_slope: Slope,
    motor_before: Option<[f32; 2]>,
    /// See `gyro_reversed`.
    motor_reversed: bool,
}

impl SignCheckState {
    /// Slopes of gyro and motor, 1 as expected; `None` while the excitation is too small.
    pub fn slopes(&self) -> [Option<f32>; 2] {
        [self.gyro_slope.value(&GYRO), self.motor_slope.value(&MOTOR)]
    }
}

/// One control period. `motion` is estimated from `measurements`; `torque_nm` is the torque requested in the previous
/// period, in the bicycle's sign \[N m\].
pub fn step(
    plan: &SignCheckPlan,
    state: &mut SignCheckState,
    measurements: &Measurements,
    motion: &Motion,
    torque_nm: f32,
) -> Causes {
    state.gyro_tick = if state.gyro_tick < plan.gyro_ticks { state.gyro_tick + 1 } else { 1 };
    state.motor_tick = if state.motor_tick < plan.motor_ticks { state.motor_tick + 1 } else { 1 };
    // Gyro and motor blocks end in different periods, which spreads the work.
    let gyro_end = state.gyro_tick == plan.motor_ticks / 2;
    let motor_end = state.motor_tick == plan.motor_ticks;
    // The gyro's means take every second period, the motor's every fourth; at 1 kHz no block ends in these.
    let (adds_gyro, adds_motor) = (state.motor_tick % 2 == 1, state.motor_tick % 4 == 1);
    let speed = measurements.rear_wheel_m_s().or(measurements.front_wheel_m_s());
    let mut causes = Causes::NONE;

    match (measurements.gyro_rad_s(), measurements.accel_m_s2(), speed) {
        (Some([wx, wy, wz]), Some([_, force, _]), Some(speed)) if plan.config.gyro => {
            if adds_gyro {
                state.gyro.add([wx, wy, wz, force, speed.newest]);
            }
            if gyro_end {
                state.gyro_reversed = state.end_gyro_block(plan).is_some_and(|s| s < GYRO_WRONG);
            }
        }
        _ if plan.config.gyro => {
            cold_path();
            (state.gyro, state.gyro_before) = Default::default();
            (state.gyro_slope, state.gyro_reversed) = Default::default();
        }
        _ => {}
    }
    match (
        &plan.config.motor,
        measurements.steer_rad(),
        measurements.steer_rate_rad_s(),
        measurements.gyro_rad_s(),
        speed,
    ) {
        (Some(model), Some(steer), Some(rate), Some(_), Some(speed)) if speed.newest > RIDING_M_S => {
            let Motion { roll_rad, roll_rate_rad_s, .. } = *motion;
            if adds_motor {
                // The reported torque is preferred: the drive may have reduced the request.
                let torque_nm = measurements.motor_torque_nm().unwrap_or(torque_nm);
                state.motor.add([roll_rad, roll_rate_rad_s, steer, rate, speed.newest, torque_nm]);
            }
            if motor_end {
                state.motor_reversed =
                    state.end_motor_block(model, &plan.motor).is_some_and(|s| s < MOTOR_WRONG);
            }
        }
        (Some(_), ..) => {
            cold_path();
            (state.motor, state.motor_before) = Default::default();
            (state.motor_slope, state.motor_reversed) = Default::default();
        }
        (None, ..) => {}
    }
    causes.note(Cause::GyroDisagrees, state.gyro_reversed);
    causes.note(Cause::WrongResponse, state.motor_reversed);
    causes
}

impl SignCheckState {
    /// Ends a gyro block; returns the slope at the instant between it and the previous one.
    fn end_gyro_block(&mut self, plan: &SignCheckPlan) -> Option<f32> {
        let (now, before) = self.gyro.end()?;
        let SignCheckPlan { imu, wheel_radius_m, gyro, .. } = plan;
        let [wx, wy, wz, force, speed] = midpoint(now, before);
        let rate = |i: usize| (now.get(i).unwrap_or(&0.0) - before.get(i).unwrap_or(&0.0)) / gyro.dt_s;
        let rolling = speed - wy * wheel_radius_m;
        let swing = wy * (wx * imu.forward_m + wz * (wheel_radius_m - imu.up_m));
        let measured = force - rolling * wz - imu.forward_m * rate(2) - swing;
        let expected = imu.up_m * rate(0);
        let [expected_before, measured_before] = self.gyro_before.replace([expected, measured])?;
        // Gravity's term is the integral of the roll rate; its change is the rate.
        let [wx_before, ..] = before;
        let expected_change = expected - expected_before - G * gyro.dt_s * wx_before;
        self.gyro_slope.step(gyro, expected_change, measured - measured_before)
    }

    /// Ends a motor block; returns the slope at the instant between it and the previous one.
    fn end_motor_block(&mut self, m: &SteerModel, plan: &SlopePlan) -> Option<f32> {
        let (now, before) = self.motor.end()?;
        let [roll, roll_rate, steer, steer_rate, v, torque] = midpoint(now, before);
        let ([.., rate_now, _, _], [.., rate_before, _, _]) = (now, before);
        let explained = v * (m.roll_rate * roll_rate + m.steer_rate * steer_rate)
            + (m.roll + v * v * m.roll_v2) * roll
            + (m.steer + v * v * m.steer_v2) * steer;
        let measured = (rate_now - rate_before) / plan.dt_s - explained;
        let expected = m.per_nm * torque;
        let [expected_before, measured_before] = self.motor_before.replace([expected, measured])?;
        self.motor_slope.step(plan, expected - expected_before, measured - measured_before)
    }
}

/// Means of two blocks, which are the values halfway between them.
fn midpoint<const N: usize>(now: [f32; N], before: [f32; N]) -> [f32; N] {
    let mut mean = now;
    for (m, b) in mean.iter_mut().zip(before) {
        *m = 0.5 * (*m + b);
    }
    mean
}
