//! Exact sensor values from the bicycle's motion.

use crate::bicycle::{Geometry, Pose, Velocities};
use crate::num::{Vec3, sin_cos};

/// Roll rate that the gyro reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Imu {
    /// The exact rate of the roll angle (the published laws' signal).
    Euler,
    /// The rear frame's angular velocity about its own x axis, as measured by a gyro on it.
    Body,
}

/// Sensors of the bicycle; each has its own sampling.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sensor {
    /// Rate gyroscope, three axes \[rad/s\].
    Gyro,
    /// Accelerometer, three axes \[m/s^2\].
    Accel,
    /// Absolute steer angle \[rad\].
    Steer,
    /// Steer rate from the motor's encoder \[rad/s\].
    SteerRate,
    /// Forward speed from the front wheel \[m/s\].
    FrontWheel,
    /// Forward speed from the rear wheel \[m/s\].
    RearWheel,
    /// Torque of the rider on the handlebar \[N m\].
    RiderTorque,
    /// Torque that the motor's drive reports \[N m\].
    MotorReport,
    /// Path tracker: heading \[rad\] and lateral deviation \[m\].
    Path,
}

impl Sensor {
    /// All sensors.
    pub const ALL: [Self; 9] = [
        Self::Gyro,
        Self::Accel,
        Self::Steer,
        Self::SteerRate,
        Self::FrontWheel,
        Self::RearWheel,
        Self::RiderTorque,
        Self::MotorReport,
        Self::Path,
    ];

    /// Name on the command line and in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gyro => "gyro",
            Self::Accel => "accel",
            Self::Steer => "steer",
            Self::SteerRate => "steer-rate",
            Self::FrontWheel => "front-wheel",
            Self::RearWheel => "rear-wheel",
            Self::RiderTorque => "rider-torque",
            Self::MotorReport => "motor-report",
            Self::Path => "path",
        }
    }

    /// Name in the keys of the firmware's parameters, `input.NAME`, and of maps.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Gyro => "gyro",
            Self::Accel => "accel",
            Self::Steer => "steer",
            Self::SteerRate => "steer_rate",
            Self::FrontWheel => "front_wheel",
            Self::RearWheel => "rear_wheel",
            Self::RiderTorque => "rider_torque",
            Self::MotorReport => "motor",
            Self::Path => "path",
        }
    }

    /// Names of the axes; none for a sensor with one axis.
    pub const fn axes(self) -> &'static [&'static str] {
        match self {
            Self::Gyro | Self::Accel => &["x", "y", "z"],
            Self::Path => &["heading", "lateral"],
            _ => &[],
        }
    }
}

/// Exact values at one control instant in Meijaard's axes fixed to the rear frame: x forward and horizontal
/// when upright, y right, z down.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Reading {
    /// Angular velocity of the rear frame \[rad/s\]; the x component as selected by [`Imu`].
    pub gyro_rad_s: [f64; 3],
    /// Specific force at the IMU, mean over the last control period \[m/s^2\].
    pub accel_m_s2: [f64; 3],
    /// Steer angle \[rad\].
    pub steer_rad: f64,
    /// Steer rate \[rad/s\].
    pub steer_rate_rad_s: f64,
    /// Front wheel's rotation rate times its radius, forward positive \[m/s\].
    pub front_wheel_m_s: f64,
    /// Rear wheel's rotation rate times its radius, forward positive \[m/s\].
    pub rear_wheel_m_s: f64,
    /// The rider's torque on the handlebar \[N m\].
    pub rider_torque_nm: f64,
    /// The motor's torque on the steer axis \[N m\].
    pub motor_torque_nm: f64,
    /// Heading of the rear frame relative to the start, right positive \[rad\].
    pub heading_rad: f64,
    /// Lateral deviation of the rear contact from the line of the start, right positive \[m\].
    pub lateral_m: f64,
}

impl Reading {
    /// Straight, upright, steady riding at `speed_m_s` in the gravity `g` \[m/s^2\].
    pub fn steady(speed_m_s: f64, g: f64) -> Self {
        Self {
            gyro_rad_s: [0.0; 3],
            accel_m_s2: [0.0, 0.0, -g],
            steer_rad: 0.0,
            steer_rate_rad_s: 0.0,
            front_wheel_m_s: speed_m_s,
            rear_wheel_m_s: speed_m_s,
            rider_torque_nm: 0.0,
            motor_torque_nm: 0.0,
            heading_rad: 0.0,
            lateral_m: 0.0,
        }
    }

    /// The sum of this and two other readings, each by its weight.
    pub fn combined(&self, weights: [f64; 3], second: &Self, third: &Self) -> Self {
        let one =
            |of: fn(&Self) -> f64| weights[0] * of(self) + weights[1] * of(second) + weights[2] * of(third);
        let three = |of: fn(&Self) -> [f64; 3]| {
            let (a, b, c) = (of(self), of(second), of(third));
            std::array::from_fn(|i| weights[0] * a[i] + weights[1] * b[i] + weights[2] * c[i])
        };
        Self {
            gyro_rad_s: three(|r| r.gyro_rad_s),
            accel_m_s2: three(|r| r.accel_m_s2),
            steer_rad: one(|r| r.steer_rad),
            steer_rate_rad_s: one(|r| r.steer_rate_rad_s),
            front_wheel_m_s: one(|r| r.front_wheel_m_s),
            rear_wheel_m_s: one(|r| r.rear_wheel_m_s),
            rider_torque_nm: one(|r| r.rider_torque_nm),
            motor_torque_nm: one(|r| r.motor_torque_nm),
            heading_rad: one(|r| r.heading_rad),
            lateral_m: one(|r| r.lateral_m),
        }
    }

    /// Values of one sensor in the order of [`Sensor::axes`]; unused components are zero.
    pub fn of(&self, sensor: Sensor) -> [f64; 3] {
        match sensor {
            Sensor::Gyro => self.gyro_rad_s,
            Sensor::Accel => self.accel_m_s2,
            Sensor::Steer => [self.steer_rad, 0.0, 0.0],
            Sensor::SteerRate => [self.steer_rate_rad_s, 0.0, 0.0],
            Sensor::FrontWheel => [self.front_wheel_m_s, 0.0, 0.0],
            Sensor::RearWheel => [self.rear_wheel_m_s, 0.0, 0.0],
            Sensor::RiderTorque => [self.rider_torque_nm, 0.0, 0.0],
            Sensor::MotorReport => [self.motor_torque_nm, 0.0, 0.0],
            Sensor::Path => [self.heading_rad, self.lateral_m, 0.0],
        }
    }
}

/// Integrated heading and path, and the previous instant, needed for heading, lateral deviation and specific
/// force.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Odometry {
    heading_rad: f64,
    lateral_m: f64,
    last: Option<Last>,
}

/// The previous control instant, in inertial axes: forward at the start, right, down.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
struct Last {
    /// Velocity of the IMU \[m/s\].
    velocity: Vec3<f64>,
    /// The rear frame's axes.
    axes: [Vec3<f64>; 3],
    /// Yaw rate \[rad/s\].
    yaw_rate: f64,
    /// Lateral speed of the rear contact, right positive \[m/s\].
    sideways: f64,
}

/// Motion of the rear frame at a control instant.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// The rear wheel's heading, as in [`Pose`].
    pub e1: Vec3<f64>,
    /// Vertical, down.
    pub k: Vec3<f64>,
    /// The velocities.
    pub velocities: Velocities<f64>,
    /// Steer angle \[rad\].
    pub steer_rad: f64,
}

impl Frame {
    /// From a pose, its velocities and the steer angle \[rad\].
    pub fn new(pose: &Pose<f64>, velocities: &Velocities<f64>, steer_rad: f64) -> Self {
        Self { e1: pose.e1, k: pose.k, velocities: *velocities, steer_rad }
    }
}

impl Odometry {
    /// Exact values `period_s` after the previous ones; zero acceleration is assumed at the first instant.
    /// `imu_point_m` is the IMU's position from the rear wheel's centre: forward, right, down.
    ///
    /// Heading and deviation are integrated by the trapezoidal rule (error of the order of the period
    /// squared). The caller fills in the torques.
    pub fn read(
        &mut self,
        b: &Geometry,
        imu: Imu,
        imu_point_m: [f64; 3],
        period_s: f64,
        now: &Frame,
    ) -> Reading {
        let v = &now.velocities;
        let (sin_lam, cos_lam) = sin_cos(b.lam);
        if let Some(last) = &self.last {
            self.heading_rad += 0.5 * period_s * (last.yaw_rate + v.yaw);
        }
        let (sin, cos) = sin_cos(self.heading_rad);
        let right = now.k.cross(now.e1);
        let standing = |w: Vec3<f64>| {
            let (ahead, aside) = (w.dot(now.e1), w.dot(right));
            Vec3::new(ahead * cos - aside * sin, ahead * sin + aside * cos, w.dot(now.k))
        };
        let directions =
            [Vec3::new(cos_lam, 0.0, sin_lam), Vec3::new(0.0, 1.0, 0.0), Vec3::new(-sin_lam, 0.0, cos_lam)];
        let [x, y, z] = imu_point_m;
        let [ux, uy, uz] = directions;
        let arm = ux.times(x) + uy.times(y) + uz.times(z);
        let velocity = standing(v.axle(b, now.e1) + v.omega.cross(arm));
        let axes = directions.map(standing);
        let sideways = (v.pitch + v.rear_spin) * -b.rR * sin;
        let gravity = Vec3::new(0.0, 0.0, b.g);
        let accel_m_s2 = match &self.last {
            None => axes.map(|axis| -gravity.dot(axis)),
            Some(last) => {
                self.lateral_m += 0.5 * period_s * (last.sideways + sideways);
                let force = (velocity - last.velocity).times(1.0 / period_s) - gravity;
                // The accelerometer rotates with the frame while it integrates: mean of both ends.
                let mean = |i: usize| 0.5 * (force.dot(last.axes[i]) + force.dot(axes[i]));
                [mean(0), mean(1), mean(2)]
            }
        };
        self.last = Some(Last { velocity, axes, yaw_rate: v.yaw, sideways });
        let rate_x = match imu {
            Imu::Euler => v.roll,
            Imu::Body => v.omega.dot(ux),
        };
        Reading {
            gyro_rad_s: [rate_x, v.omega.y, v.omega.dot(uz)],
            accel_m_s2,
            steer_rad: now.steer_rad,
            steer_rate_rad_s: v.steer,
            front_wheel_m_s: v.front_spin * -b.rF,
            rear_wheel_m_s: v.rear_spin * -b.rR,
            rider_torque_nm: 0.0,
            motor_torque_nm: 0.0,
            heading_rad: self.heading_rad,
            lateral_m: self.lateral_m,
        }
    }
}
