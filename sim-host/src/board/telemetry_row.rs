//! A control step of the telemetry as a row of a table. Columns that `ride` has too have the same names.

use control::{Sample, Triple, sensors::frame::MISSING};
use link::telemetry::Telemetry;
use schemars::JsonSchema;
use serde::Serialize;

/// One control step as reported by the board. Sensor values are raw: in the sensor's own axes, zeros and signs; empty
/// without a sample.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TelemetryRow {
    /// The board's clock \[s\].
    pub t: f64,
    /// Control steps done, this one included.
    pub steps: u32,
    /// Steps that missed their deadline.
    pub late: u32,
    /// Whether the command reached the motor.
    pub driven: bool,
    /// Mode of the controller, as the number of [`control::Mode`].
    pub mode: u8,
    /// Causes that prevented or reduced torque, as bits of [`control::Causes`].
    pub causes: u64,
    /// Limits that changed the torque, as bits of [`control::ActiveLimits`].
    pub limits: u16,
    /// The steer torque the assist commanded \[N m\].
    pub torque: f32,
    /// The gain \[N m s/rad\].
    pub gain: f32,
    /// Whether the rider's switch requests assist.
    pub engage: bool,
    /// The gyro about x \[rad/s\].
    pub measured_roll_rate: Option<f32>,
    /// The gyro about y \[rad/s\].
    pub measured_pitch_rate: Option<f32>,
    /// The gyro about z \[rad/s\].
    pub measured_yaw_rate: Option<f32>,
    /// Control periods since the gyro's sample.
    pub gyro_age: Option<u16>,
    /// Specific force along x \[m/s^2\].
    pub measured_accel_x: Option<f32>,
    /// Specific force along y \[m/s^2\].
    pub measured_accel_y: Option<f32>,
    /// Specific force along z \[m/s^2\].
    pub measured_accel_z: Option<f32>,
    /// Control periods since the accelerometer's sample.
    pub accel_age: Option<u16>,
    /// Steer angle \[rad\].
    pub measured_steer: Option<f32>,
    /// Control periods since the steer angle's sample.
    pub steer_age: Option<u16>,
    /// Steer rate \[rad/s\].
    pub measured_steer_rate: Option<f32>,
    /// Control periods since the steer rate's sample.
    pub steer_rate_age: Option<u16>,
    /// Front wheel's forward speed \[m/s\].
    pub measured_front_speed: Option<f32>,
    /// Control periods since the front wheel's sample.
    pub front_speed_age: Option<u16>,
    /// Rear wheel's forward speed \[m/s\].
    pub measured_rear_speed: Option<f32>,
    /// Control periods since the rear wheel's sample.
    pub rear_speed_age: Option<u16>,
    /// The rider's steer torque \[N m\].
    pub measured_rider_torque: Option<f32>,
    /// Control periods since the rider torque's sample.
    pub rider_torque_age: Option<u16>,
    /// The torque that the drive reports \[N m\].
    pub measured_motor_torque: Option<f32>,
    /// Control periods since the drive's report.
    pub motor_torque_age: Option<u16>,
    /// Regression gain of the gyro's sign check: 1 as expected, -1 reversed.
    pub gyro_slope: Option<f32>,
    /// Regression gain of the motor's sign check: 1 as expected, -1 reversed.
    pub motor_slope: Option<f32>,
    /// Next action of the polarity check, as the number of [`control::sensors::polarity::PolarityStep`].
    pub polarity: u8,
    /// The torque that the law would request during the polarity check \[N m\].
    pub shown_torque: f32,
    /// The lower half of `causes`, which has more bits than a double holds exactly.
    pub causes_low: u32,
    /// The upper half of `causes`.
    pub causes_high: u32,
}

impl TelemetryRow {
    /// The row of a control step at `t` on the board's clock \[s\].
    pub fn new(t: f64, received: &Telemetry) -> Self {
        let Telemetry { steps, late, driven, frame, command, slopes, polarity, polarity_torque_nm } =
            received;
        let ([roll_rate, pitch_rate, yaw_rate], gyro_age) = triple(&frame.gyro_rad_s);
        let ([x, y, z], accel_age) = triple(&frame.accel_m_s2);
        let (steer, steer_age) = sample(&frame.steer_rad);
        let (steer_rate, steer_rate_age) = sample(&frame.steer_rate_rad_s);
        let (front_speed, front_speed_age) = sample(&frame.front_wheel_m_s);
        let (rear_speed, rear_speed_age) = sample(&frame.rear_wheel_m_s);
        let (rider_torque, rider_torque_age) = sample(&frame.rider_torque_nm);
        let (motor_torque, motor_torque_age) = sample(&frame.motor_torque_nm);
        let [gyro_slope, motor_slope] = *slopes;
        Self {
            t,
            steps: *steps,
            late: *late,
            driven: *driven,
            mode: command.mode as u8,
            causes: command.causes.0,
            limits: command.limits.0,
            torque: command.torque_nm,
            gain: command.gain_nm_s_rad,
            engage: frame.engage,
            measured_roll_rate: roll_rate,
            measured_pitch_rate: pitch_rate,
            measured_yaw_rate: yaw_rate,
            gyro_age,
            measured_accel_x: x,
            measured_accel_y: y,
            measured_accel_z: z,
            accel_age,
            measured_steer: steer,
            steer_age,
            measured_steer_rate: steer_rate,
            steer_rate_age,
            measured_front_speed: front_speed,
            front_speed_age,
            measured_rear_speed: rear_speed,
            rear_speed_age,
            measured_rider_torque: rider_torque,
            rider_torque_age,
            measured_motor_torque: motor_torque,
            motor_torque_age,
            gyro_slope,
            motor_slope,
            polarity: *polarity,
            shown_torque: *polarity_torque_nm,
            causes_low: command.causes.0 as u32,
            causes_high: (command.causes.0 >> 32) as u32,
        }
    }
}

fn sample(sample: &Sample) -> (Option<f32>, Option<u16>) {
    let there = sample.age_ticks != MISSING;
    (there.then_some(sample.value), there.then_some(sample.age_ticks))
}

fn triple(triple: &Triple) -> ([Option<f32>; 3], Option<u16>) {
    let there = triple.age_ticks != MISSING;
    (triple.value.map(|value| there.then_some(value)), there.then_some(triple.age_ticks))
}
