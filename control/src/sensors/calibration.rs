//! Converts samples from the sensors' axes, zeros and signs to the bicycle's, and the torque to the motor's sign.

use crate::param::{ParamSpec, ParamVisitor};
use crate::sensors::frame::{Sample, Triple};
use core::f32::consts::PI;

/// Mounting, zeros and signs of sensors and motor. The default is the identity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Calibration {
    /// Rotation from the IMU's axes to the rear frame's: about z, then y, then x \[rad\]. Stored in the order x, y, z
    /// as the roll, pitch and yaw of the IMU on the frame.
    pub imu_rad: [f32; 3],
    /// Gyro bias (its reading at rest), in the IMU's axes \[rad/s\].
    pub gyro_bias_rad_s: [f32; 3],
    /// Accelerometer bias (reading less true value), in the IMU's axes \[m/s^2\].
    pub accel_bias_m_s2: [f32; 3],
    /// Steer sensor reading with the front wheel straight ahead, in the sensor's own sign \[rad\].
    pub steer_zero_rad: f32,
    /// The steer sensor is positive to the left.
    pub steer_reversed: bool,
    /// The motor's encoder is positive to the left.
    pub steer_rate_reversed: bool,
    /// The rider's torque sensor is positive to the left.
    pub rider_torque_reversed: bool,
    /// A positive command turns the motor to the left; its torque report has the same sign.
    pub motor_reversed: bool,
    /// A polarity check was passed with this calibration.
    pub polarity_checked: bool,
}

const G: &str = "calibration";

impl Calibration {
    /// Visits every parameter.
    pub fn visit_params<V: ParamVisitor>(&mut self, to: &mut V) {
        let [roll, pitch, yaw] = &mut self.imu_rad;
        to.number(&ParamSpec::new(G, "imu_roll_rad", -PI, PI), roll);
        to.number(&ParamSpec::new(G, "imu_pitch_rad", -PI, PI), pitch);
        to.number(&ParamSpec::new(G, "imu_yaw_rad", -PI, PI), yaw);
        let [x, y, z] = &mut self.gyro_bias_rad_s;
        to.number(&ParamSpec::new(G, "gyro_bias_x_rad_s", -0.5, 0.5), x);
        to.number(&ParamSpec::new(G, "gyro_bias_y_rad_s", -0.5, 0.5), y);
        to.number(&ParamSpec::new(G, "gyro_bias_z_rad_s", -0.5, 0.5), z);
        let [x, y, z] = &mut self.accel_bias_m_s2;
        to.number(&ParamSpec::new(G, "accel_bias_x_m_s2", -3.0, 3.0), x);
        to.number(&ParamSpec::new(G, "accel_bias_y_m_s2", -3.0, 3.0), y);
        to.number(&ParamSpec::new(G, "accel_bias_z_m_s2", -3.0, 3.0), z);
        to.number(&ParamSpec::new(G, "steer_zero_rad", -PI, PI), &mut self.steer_zero_rad);
        to.switch(&ParamSpec::switch(G, "steer_reversed"), &mut self.steer_reversed);
        to.switch(&ParamSpec::switch(G, "steer_rate_reversed"), &mut self.steer_rate_reversed);
        to.switch(&ParamSpec::switch(G, "rider_torque_reversed"), &mut self.rider_torque_reversed);
        to.switch(&ParamSpec::switch(G, "motor_reversed"), &mut self.motor_reversed);
        to.switch(&ParamSpec::switch(G, "polarity_checked"), &mut self.polarity_checked);
    }

    /// Computes the constants of [`CalibrationPlan`].
    pub fn plan(&self) -> CalibrationPlan {
        let rotated = self.imu_rad.iter().any(|angle| *angle != 0.0);
        let sign = |reversed: bool| if reversed { -1.0 } else { 1.0 };
        CalibrationPlan {
            imu: rotated.then(|| rotation(self.imu_rad)),
            gyro_bias_rad_s: self.gyro_bias_rad_s,
            accel_bias_m_s2: self.accel_bias_m_s2,
            steer_zero_rad: self.steer_zero_rad,
            steer_sign: sign(self.steer_reversed),
            steer_rate_sign: sign(self.steer_rate_reversed),
            rider_torque_sign: sign(self.rider_torque_reversed),
            motor_sign: sign(self.motor_reversed),
        }
    }
}

/// Constants derived from a calibration; converts each sample to the bicycle's axes, zero and sign. A value that needs
/// no conversion is unchanged to the bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibrationPlan {
    /// Rows of the rotation from the IMU's to the frame's axes; `None` for the identity.
    imu: Option<[[f32; 3]; 3]>,
    gyro_bias_rad_s: [f32; 3],
    accel_bias_m_s2: [f32; 3],
    steer_zero_rad: f32,
    /// +1, or -1 if reversed.
    steer_sign: f32,
    steer_rate_sign: f32,
    rider_torque_sign: f32,
    motor_sign: f32,
}

impl CalibrationPlan {
    /// Angular velocity \[rad/s\].
    pub fn gyro(&self, sample: &Triple) -> [f32; 3] {
        self.rotated(sample.value, &self.gyro_bias_rad_s)
    }

    /// Specific force \[m/s^2\].
    pub fn accel(&self, sample: &Triple) -> [f32; 3] {
        self.rotated(sample.value, &self.accel_bias_m_s2)
    }

    /// Steer angle \[rad\].
    pub fn steer(&self, sample: &Sample) -> f32 {
        self.steer_sign * (sample.value - self.steer_zero_rad)
    }

    /// Steer rate \[rad/s\].
    pub fn steer_rate(&self, sample: &Sample) -> f32 {
        self.steer_rate_sign * sample.value
    }

    /// The rider's torque \[N m\].
    pub fn rider_torque(&self, sample: &Sample) -> f32 {
        self.rider_torque_sign * sample.value
    }

    /// Torque reported by the drive \[N m\].
    pub fn motor_report(&self, sample: &Sample) -> f32 {
        self.motor_sign * sample.value
    }

    /// Torque command in the motor's sign \[N m\].
    pub fn motor(&self, torque_nm: f32) -> f32 {
        self.motor_sign * torque_nm
    }

    fn rotated(&self, [x, y, z]: [f32; 3], [bx, by, bz]: &[f32; 3]) -> [f32; 3] {
        let (x, y, z) = (x - bx, y - by, z - bz);
        match &self.imu {
            None => [x, y, z],
            Some(rows) => rows.map(|[a, b, c]| a * x + b * y + c * z),
        }
    }
}

/// Rows of the rotation matrix from axes turned by roll, pitch and yaw back to the original axes.
fn rotation([roll, pitch, yaw]: [f32; 3]) -> [[f32; 3]; 3] {
    let ((sr, cr), (sp, cp), (sy, cy)) = (libm::sincosf(roll), libm::sincosf(pitch), libm::sincosf(yaw));
    [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
}
