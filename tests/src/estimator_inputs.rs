//! Exact sensor values on the bicycle, by exact differentiation; noise of a stated size.

use crate::flow::{along, rear_axle_velocity};
use control::estimate::{EstimatorInput, Place};
use sim_host::bicycle::{Geometry, State, Torques};
use sim_host::num::Dual;
use sim_host::ride::{Conditions, Start, TracePoint, traced};

/// True motion at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Truth {
    /// Roll \[rad\].
    pub roll: f64,
    /// Roll rate \[rad/s\].
    pub roll_rate: f64,
    /// Roll acceleration \[rad/s^2\].
    pub roll_accel: f64,
    /// Yaw rate \[rad/s\].
    pub yaw_rate: f64,
    /// Pitch \[rad\].
    pub pitch: f64,
    /// Steer \[rad\].
    pub steer: f64,
    /// Steer rate \[rad/s\].
    pub steer_rate: f64,
    /// Rear wheel's forward speed \[m/s\].
    pub speed: f64,
    /// Front wheel's forward speed \[m/s\].
    pub front_speed: f64,
    /// Body rates about x, y, z \[rad/s\].
    pub gyro: [f64; 3],
    /// Specific force of an accelerometer at the given position, along x, y, z \[m/s^2\].
    pub accel: [f64; 3],
}

type Triple = [Dual; 3];

fn cross([a, b, c]: Triple, [x, y, z]: Triple) -> Triple {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

/// The true motion, and the specific force at `place`, in a state under `torques`.
pub fn truth(b: &Geometry, state: &State<f64>, torques: &Torques<f64>, place: &Place) -> Truth {
    let (moving, motion) = along(b, state, torques);
    let constant = |re: f64| Dual { re, eps: 0.0 };
    let (s, c) = (constant(b.lam.sin()), constant(b.lam.cos()));
    let w = motion.actual.omega;
    let omega = [w.x * c + w.z * s, w.y, w.z * c - w.x * s];
    // Body axes seen from the ground (heading, right, down): yaw rate only turns them in time.
    let (sr, cr) = motion.pose.attitude.roll;
    let pitch = motion.pose.attitude.pitch;
    let (sp, cp) = {
        let (s, c) = pitch.re.sin_cos();
        (Dual { re: s, eps: c * pitch.eps }, Dual { re: c, eps: -s * pitch.eps })
    };
    let yaw = Dual { re: 0.0, eps: motion.actual.yaw.re };
    let zero = constant(0.0);
    // Axes at the moment's heading; turned by yaw, whose sine is `yaw` and whose cosine is 1.
    let turned = |[x, y, z]: Triple| [x - yaw * y, yaw * x + y, z];
    let axes = [turned([cp, sr * sp, -(cr * sp)]), turned([zero, cr, sr]), turned([sp, -(sr * cp), cr * cp])];
    let arm = [f64::from(place.forward_m), 0.0, b.rR - f64::from(place.up_m)];
    let swing = cross(omega, arm.map(constant));
    let axle = rear_axle_velocity(b, &moving, &motion);
    let mut accel = [0.0; 3];
    let mut velocity = axle;
    for (v, i) in velocity.iter_mut().zip(0..3) {
        for (axis, part) in axes.iter().zip(swing) {
            *v = *v + axis[i] * part;
        }
    }
    let force = [velocity[0].eps, velocity[1].eps, velocity[2].eps - b.g];
    for (a, axis) in accel.iter_mut().zip(axes) {
        *a = force.iter().zip(axis).map(|(f, e)| f * e.re).sum();
    }
    Truth {
        roll: state.roll,
        roll_rate: state.roll_rate,
        roll_accel: moving.roll_rate.eps,
        yaw_rate: motion.actual.yaw.re,
        pitch: pitch.re,
        steer: state.steer,
        steer_rate: state.steer_rate,
        speed: motion.actual.rear_spin.re * -b.rR,
        front_speed: motion.actual.front_spin.re * -b.rF,
        gyro: omega.map(|w| w.re),
        accel,
    }
}

impl Truth {
    /// Values of exact sensors after `elapsed_us`.
    pub fn estimator_input(&self, elapsed_us: u32) -> EstimatorInput {
        EstimatorInput {
            gyro_rad_s: self.gyro.map(|w| w as f32),
            accel_m_s2: Some(self.accel.map(|a| a as f32)),
            steer_rad: Some(self.steer as f32),
            steer_rate_rad_s: Some(self.steer_rate as f32),
            speed_m_s: self.speed as f32,
            elapsed_us,
        }
    }
}

impl Truth {
    /// The instant `now`, with the mean specific force over the period since `before`.
    pub fn between(before: &Self, now: &Self) -> Self {
        let mut accel = now.accel;
        accel.iter_mut().zip(before.accel).for_each(|(a, b)| *a = 0.5 * (*a + b));
        Self { accel, ..*now }
    }
}

/// The true motion at every control instant of a ride.
pub fn ridden(conditions: &Conditions, start: Start, place: &Place) -> Vec<Truth> {
    let b = &conditions.bicycle;
    let at = |p: &TracePoint| {
        let (roll, steer, pitch) = (p.roll, p.steer, p.pitch);
        let (roll_rate, steer_rate, rear_wheel_rate) = (p.roll_rate, p.steer_rate, p.rear_wheel_rate);
        let state = State { roll, steer, pitch, roll_rate, steer_rate, rear_wheel_rate };
        truth(b, &state, &Torques { roll: 0.0, steer: p.torque + p.rider_torque }, place)
    };
    traced(conditions, start).1.iter().map(at).collect()
}

/// Sensor noise: normal deviates of the sizes in [`Noise::SIZES`], a new sample every 10 ms.
#[derive(Clone, Debug)]
pub struct Noise {
    random: u64,
    tick: u32,
    held: [f32; 9],
}

impl Noise {
    /// Standard deviations of gyro \[rad/s\], accelerometer \[m/s^2\], steer \[rad\], steer rate \[rad/s\] and speed
    /// \[m/s\]: the values of chris-konrad/stochastic-balancing-rider (MIT), scripts/config.yaml, for the TU Delft
    /// sensor bicycle, sampled at 100 Hz.
    pub const SIZES: [f32; 5] = [0.054, 0.30, 0.03, 0.05, 0.05];

    /// The same noise for the same seed.
    pub fn new(seed: u64) -> Self {
        Self { random: seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1, tick: 0, held: [0.0; 9] }
    }

    /// A normal deviate, as a sum of twelve uniform ones.
    fn normal(&mut self) -> f32 {
        let mut sum = -6.0;
        for _ in 0..12 {
            self.random ^= self.random << 13;
            self.random ^= self.random >> 7;
            self.random ^= self.random << 17;
            sum += (self.random >> 40) as f32 / (1_u32 << 24) as f32;
        }
        sum
    }

    /// Adds the noise of the next millisecond.
    pub fn on(&mut self, input: &mut EstimatorInput) {
        if self.tick.is_multiple_of(10) {
            let [gyro, accel, steer, steer_rate, speed] = Self::SIZES;
            let sizes = [gyro, gyro, gyro, accel, accel, accel, steer, steer_rate, speed];
            self.held = sizes.map(|size| size * self.normal());
        }
        self.tick += 1;
        let [gx, gy, gz, ax, ay, az, steer, steer_rate, speed] = self.held;
        for (w, n) in input.gyro_rad_s.iter_mut().zip([gx, gy, gz]) {
            *w += n;
        }
        input.accel_m_s2 = input.accel_m_s2.map(|[x, y, z]| [x + ax, y + ay, z + az]);
        input.steer_rad = input.steer_rad.map(|s| s + steer);
        input.steer_rate_rad_s = input.steer_rate_rad_s.map(|s| s + steer_rate);
        input.speed_m_s += speed;
    }
}
