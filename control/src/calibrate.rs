//! From the sensors' own axes, zeros and signs to the bicycle's, and from its torque to the motor's.

use crate::frame::{Sample, SensorFrame, Triple};
use crate::param::{Leaf, Visit};
use core::f32::consts::PI;

/// How sensors and motor sit on this bicycle. The default is a bicycle on which all is as drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Calibration {
    /// Rotation from the IMU's axes to the rear frame's: about z, then y, then x \[rad\], as yaw,
    /// pitch and roll of the IMU on the frame, in the order x, y, z.
    pub imu_rad: [f32; 3],
    /// What the gyro shows at rest, in the IMU's axes \[rad/s\].
    pub gyro_bias_rad_s: [f32; 3],
    /// What the accelerometer shows too much, in the IMU's axes \[m/s^2\].
    pub accel_bias_m_s2: [f32; 3],
    /// What the steer sensor shows when the front wheel points ahead \[rad\], in its own sign.
    pub steer_zero_rad: f32,
    /// The steer sensor counts to the left.
    pub steer_reversed: bool,
    /// The motor's encoder counts to the left.
    pub steer_rate_reversed: bool,
    /// The rider's torque sensor counts to the left.
    pub rider_torque_reversed: bool,
    /// The motor turns to the left on a positive command, and reports its torque so.
    pub motor_reversed: bool,
    /// A polarity check was passed with this calibration.
    pub polarity_checked: bool,
}

const G: &str = "calibration";

impl Calibration {
    /// Shows every parameter.
    pub fn leaves<V: Visit>(&mut self, to: &mut V) {
        let [roll, pitch, yaw] = &mut self.imu_rad;
        to.number(&Leaf::new(G, "imu_roll_rad", -PI, PI), roll);
        to.number(&Leaf::new(G, "imu_pitch_rad", -PI, PI), pitch);
        to.number(&Leaf::new(G, "imu_yaw_rad", -PI, PI), yaw);
        let [x, y, z] = &mut self.gyro_bias_rad_s;
        to.number(&Leaf::new(G, "gyro_bias_x_rad_s", -0.5, 0.5), x);
        to.number(&Leaf::new(G, "gyro_bias_y_rad_s", -0.5, 0.5), y);
        to.number(&Leaf::new(G, "gyro_bias_z_rad_s", -0.5, 0.5), z);
        let [x, y, z] = &mut self.accel_bias_m_s2;
        to.number(&Leaf::new(G, "accel_bias_x_m_s2", -3.0, 3.0), x);
        to.number(&Leaf::new(G, "accel_bias_y_m_s2", -3.0, 3.0), y);
        to.number(&Leaf::new(G, "accel_bias_z_m_s2", -3.0, 3.0), z);
        to.number(&Leaf::new(G, "steer_zero_rad", -PI, PI), &mut self.steer_zero_rad);
        to.switch(&Leaf::switch(G, "steer_reversed"), &mut self.steer_reversed);
        to.switch(&Leaf::switch(G, "steer_rate_reversed"), &mut self.steer_rate_reversed);
        to.switch(&Leaf::switch(G, "rider_torque_reversed"), &mut self.rider_torque_reversed);
        to.switch(&Leaf::switch(G, "motor_reversed"), &mut self.motor_reversed);
        to.switch(&Leaf::switch(G, "polarity_checked"), &mut self.polarity_checked);
    }

    /// What [`CalibrationPlan::frame`] needs.
    pub fn plan(&self) -> CalibrationPlan {
        let turned = self.imu_rad.iter().any(|angle| *angle != 0.0);
        CalibrationPlan { calibration: *self, imu: turned.then(|| rotation(self.imu_rad)) }
    }
}

/// A calibration with what is derived from it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CalibrationPlan {
    calibration: Calibration,
    /// Rows of the rotation from the IMU's to the frame's axes; `None` where they are the same.
    imu: Option<[[f32; 3]; 3]>,
}

impl CalibrationPlan {
    /// The frame in the bicycle's axes, zeros and signs. What needs no change keeps its bits.
    pub fn frame(&self, told: &SensorFrame) -> SensorFrame {
        let c = &self.calibration;
        SensorFrame {
            gyro_rad_s: self.turned(&told.gyro_rad_s, &c.gyro_bias_rad_s),
            accel_m_s2: self.turned(&told.accel_m_s2, &c.accel_bias_m_s2),
            steer_rad: signed(
                Sample { value: told.steer_rad.value - c.steer_zero_rad, ..told.steer_rad },
                c.steer_reversed,
            ),
            steer_rate_rad_s: signed(told.steer_rate_rad_s, c.steer_rate_reversed),
            rider_torque_nm: signed(told.rider_torque_nm, c.rider_torque_reversed),
            motor_torque_nm: signed(told.motor_torque_nm, c.motor_reversed),
            ..*told
        }
    }

    /// The torque as the motor must be told it \[N m\].
    pub fn motor(&self, torque_nm: f32) -> f32 {
        if self.calibration.motor_reversed { -torque_nm } else { torque_nm }
    }

    fn turned(&self, told: &Triple, bias: &[f32; 3]) -> Triple {
        let [x, y, z] = told.value;
        let [bx, by, bz] = *bias;
        let (x, y, z) = (x - bx, y - by, z - bz);
        let value = match &self.imu {
            None => [x, y, z],
            Some(rows) => rows.map(|[a, b, c]| a * x + b * y + c * z),
        };
        Triple { value, ..*told }
    }
}

fn signed(sample: Sample, reversed: bool) -> Sample {
    if reversed { Sample { value: -sample.value, ..sample } } else { sample }
}

/// Rows of the rotation that takes vectors from axes turned by roll, pitch and yaw to the axes they
/// were turned from.
fn rotation([roll, pitch, yaw]: [f32; 3]) -> [[f32; 3]; 3] {
    let ((sr, cr), (sp, cp), (sy, cy)) = (libm::sincosf(roll), libm::sincosf(pitch), libm::sincosf(yaw));
    [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
}
