//! A control period as a row of the replay's table.

use control::{Command, SensorFrame, State};
use serde::Serialize;

/// One control period, as a row of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Time in the recording \[s\].
    pub t: f64,
    /// Mode of the controller, as the number of [`control::Mode`].
    pub mode: u8,
    /// Causes that prevented or reduced torque, as bits of [`control::Causes`].
    pub causes: u64,
    /// Limits that changed the torque, as bits of [`control::ActiveLimits`].
    pub limits: u16,
    /// The steer torque commanded \[N m\].
    pub torque: f32,
    /// The gain \[N m s/rad\].
    pub gain: f32,
    /// Estimated roll angle \[rad\], and its bound.
    pub roll: f32,
    /// See `roll`.
    pub roll_bound: f32,
    /// Sensor values from the controller's input; empty without a sample.
    pub measured_roll_rate: Option<f32>,
    /// The gyro about y \[rad/s\].
    pub measured_pitch_rate: Option<f32>,
    /// The gyro about z \[rad/s\].
    pub measured_yaw_rate: Option<f32>,
    /// Steer angle \[rad\].
    pub measured_steer: Option<f32>,
    /// Front wheel's speed \[m/s\].
    pub measured_front_speed: Option<f32>,
    /// Rear wheel's speed \[m/s\].
    pub measured_rear_speed: Option<f32>,
    /// Residuals of the checks between sensors; empty where there is nothing to compare.
    pub wheels_residual: Option<f32>,
    /// Of the yaw rate \[rad/s\].
    pub yaw_residual: Option<f32>,
    /// Of the steer angle \[rad\].
    pub steer_residual: Option<f32>,
    /// Of the drive's torque \[N m\].
    pub motor_residual: Option<f32>,
    /// The recording's own roll angle \[rad\].
    pub log_roll: Option<f64>,
    /// The recording's own torque \[N m\].
    pub log_torque: Option<f64>,
    /// The lower half of `causes`, which has more bits than a double holds exactly.
    pub causes_low: u32,
    /// The upper half of `causes`.
    pub causes_high: u32,
}

/// The row of this period; `log` holds the recording's own roll angle \[rad\] and torque \[N m\].
pub(super) fn row(
    t: f64,
    frame: &SensorFrame,
    state: &State,
    command: &Command,
    [log_roll, log_torque]: [Option<f64>; 2],
) -> Row {
    let there = |age: u16| age != control::sensors::frame::MISSING;
    let sample = |sample: &control::Sample| there(sample.age_ticks).then_some(sample.value);
    let [x, y, z] = frame.gyro_rad_s.value.map(|rate| there(frame.gyro_rad_s.age_ticks).then_some(rate));
    let known = |value: f32| (!value.is_nan()).then_some(value);
    let (residuals, roll) = (state.residuals(), state.roll());
    Row {
        t,
        mode: command.mode as u8,
        causes: command.causes.0,
        limits: command.limits.0,
        torque: command.torque_nm,
        gain: command.gain_nm_s_rad,
        roll: roll.angle_rad,
        roll_bound: roll.error.bound_rad(),
        measured_roll_rate: x,
        measured_pitch_rate: y,
        measured_yaw_rate: z,
        measured_steer: sample(&frame.steer_rad),
        measured_front_speed: sample(&frame.front_wheel_m_s),
        measured_rear_speed: sample(&frame.rear_wheel_m_s),
        wheels_residual: known(residuals.wheels_m_s),
        yaw_residual: known(residuals.yaw_rad_s),
        steer_residual: known(residuals.steer_rad),
        motor_residual: known(residuals.motor_nm),
        log_roll,
        log_torque,
        causes_low: command.causes.0 as u32,
        causes_high: (command.causes.0 >> 32) as u32,
    }
}
