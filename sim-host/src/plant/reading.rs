//! What exact sensors would say.

use crate::bicycle::{Geometry, Pose, Velocities};
use crate::num::{Vec3, sin_cos};
use crate::ride::Imu;

/// The sensors of the bicycle, each with a clock of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sensor {
    /// Rate gyroscope, three axes \[rad/s\].
    Gyro,
    /// Accelerometer, three axes \[m/s^2\].
    Accel,
    /// Absolute steer angle \[rad\].
    Steer,
    /// Steer rate by the motor's encoder \[rad/s\].
    SteerRate,
    /// Speed of the front wheel \[m/s\].
    FrontWheel,
    /// Speed of the rear wheel \[m/s\].
    RearWheel,
    /// Torque of the rider on the handlebar \[N m\].
    RiderTorque,
    /// Torque the motor's drive reports \[N m\].
    MotorReport,
    /// Path tracker: heading \[rad\] and lateral offset \[m\].
    Path,
}

impl Sensor {
    /// All of them.
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

    /// Its name on the command line and in files.
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

    /// Names of its axes; none if it has but one.
    pub const fn axes(self) -> &'static [&'static str] {
        match self {
            Self::Gyro | Self::Accel => &["x", "y", "z"],
            Self::Path => &["heading", "lateral"],
            _ => &[],
        }
    }
}

/// The exact values at one control instant, benchmark axes: x forward and horizontal when upright,
/// y right, z down, fixed to the rear frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Angular velocity of the rear frame; about x by [`Imu`] \[rad/s\].
    pub gyro_rad_s: [f64; 3],
    /// Specific force at the IMU, mean over the last control period \[m/s^2\].
    pub accel_m_s2: [f64; 3],
    /// Steer angle \[rad\].
    pub steer_rad: f64,
    /// Steer rate \[rad/s\].
    pub steer_rate_rad_s: f64,
    /// Front wheel's rate times its radius, forward positive \[m/s\].
    pub front_wheel_m_s: f64,
    /// Rear wheel's rate times its radius, forward positive \[m/s\].
    pub rear_wheel_m_s: f64,
    /// The rider's torque on the handlebar \[N m\].
    pub rider_torque_nm: f64,
    /// The motor's torque on the steer axis \[N m\].
    pub motor_torque_nm: f64,
    /// Heading of the rear frame from that at the start, right positive \[rad\].
    pub heading_rad: f64,
    /// Rear contact's place beside the line of the start, right positive \[m\].
    pub lateral_m: f64,
}

impl Reading {
    /// Riding straight, upright and steadily at `speed_m_s` in the gravity `g` \[m/s^2\].
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

    /// The values of one sensor in the order of [`Sensor::axes`]; zero beyond.
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

/// Where a ride is and how it got there: what heading, lateral offset and specific force need beside
/// the present velocities.
#[derive(Clone, Copy, Debug, Default)]
pub struct Odometry {
    heading_rad: f64,
    lateral_m: f64,
    last: Option<Last>,
}

/// The control instant before, in axes that stand still: forward at the start, right, down.
#[derive(Clone, Copy, Debug)]
struct Last {
    /// Velocity of the IMU \[m/s\].
    velocity: Vec3<f64>,
    /// The rear frame's axes.
    axes: [Vec3<f64>; 3],
    /// Yaw rate \[rad/s\].
    yaw_rate: f64,
    /// Speed of the rear contact to the right \[m/s\].
    sideways: f64,
}

/// The rear frame at a control instant.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// The rear wheel's heading, by [`Pose`].
    pub e1: Vec3<f64>,
    /// Vertical, down.
    pub k: Vec3<f64>,
    /// The velocities.
    pub velocities: Velocities<f64>,
    /// Steer angle \[rad\].
    pub steer_rad: f64,
}

impl Frame {
    /// Of a pose, its velocities and the steer angle \[rad\].
    pub fn new(pose: &Pose<f64>, velocities: &Velocities<f64>, steer_rad: f64) -> Self {
        Self { e1: pose.e1, k: pose.k, velocities: *velocities, steer_rad }
    }
}

impl Odometry {
    /// The exact values `period_s` after those before; at the first instant the velocity has not
    /// changed. `imu_point_m` is the IMU's place from the rear wheel's centre: forward, right, down.
    ///
    /// Heading and offset are integrated by the trapezoidal rule (error of the order of the period
    /// squared). Torques are not filled in: they are the caller's to know.
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
                // The sensor turns with the frame while it sums up: the middle of both ends.
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
