//! A recording of a simulated closed loop whose law and bicycle are known.

use crate::knock::SplitMix64;
use nalgebra::{Matrix2, Vector2};
use sim_host::bicycle::{Parameters, linear::Linear};
use sim_host::closed_loop::{Channel, Record, Signal};

/// The ride.
#[derive(Clone, Copy, Debug)]
pub struct Loop {
    /// Gain from the roll rate at 4 m/s \[N m s/rad\], and its change per m/s.
    pub roll_rate: (f64, f64),
    /// Gain from the steer angle \[N m/rad\].
    pub steer: f64,
    /// Delay of the law \[samples\].
    pub lag: usize,
    /// Time constant of a first-order low-pass behind the law \[s\]; 0: none.
    pub filter_s: f64,
    /// Standard deviation of a torque added to the law's and recorded with it \[N m\].
    pub dither_nm: f64,
    /// Standard deviation of the error of the recorded torque \[N m\].
    pub error_nm: f64,
    /// True over recorded steer angle, and true angle where the recording says zero \[rad\].
    pub scale: (f64, f64),
    /// Standard deviation of the gyro's noise \[rad/s\]; the law uses the noisy rate.
    pub gyro_rad_s: f64,
    /// Viscous friction \[N m s/rad\].
    pub viscous: f64,
    /// Duration \[s\].
    pub seconds: f64,
}

impl Default for Loop {
    fn default() -> Self {
        Self {
            roll_rate: (8.0, -2.0),
            steer: 0.0,
            lag: 0,
            filter_s: 0.0,
            dither_nm: 0.0,
            error_nm: 0.0,
            scale: (1.0, 0.0),
            gyro_rad_s: 0.0,
            viscous: 0.0,
            seconds: 40.0,
        }
    }
}

/// Time between two samples \[s\].
pub const PERIOD_S: f64 = 0.01;
/// Steps of the integration in a sample.
const STEPS: usize = 10;

/// Rides the linear bicycle with random roll torque, at a speed that rises and falls between 3.5 and 4.5 m/s.
pub fn ride(how: &Loop, bicycle: &Parameters, seed: u64) -> Record {
    let linear = Linear::new(bicycle);
    let inverse = linear.m.try_inverse().expect("a mass matrix");
    let mut random = SplitMix64(seed);
    let mut normal = move || random.normal();
    let (mut q, mut rates) = (Vector2::zeros(), Vector2::zeros());
    let (mut push, mut filtered, mut dither) = (0.0, 0.0, 0.0);
    let speed_at = |k: usize| 4.0 + 0.5 * (0.4 * k as f64 * PERIOD_S).sin();
    let mut measured: Vec<[f64; 2]> = Vec::new();
    let mut rows: Vec<[f64; 7]> = Vec::new();
    for k in 0..(how.seconds / PERIOD_S) as usize {
        let t = k as f64 * PERIOD_S;
        let (speed, then) = (speed_at(k), k.saturating_sub(how.lag));
        let roll_rate = rates[0] + how.gyro_rad_s * normal();
        measured.push([roll_rate, (q[1] - how.scale.1) / how.scale.0]);
        let [rate, angle] = measured[then];
        let gain = how.roll_rate.0 + how.roll_rate.1 * (speed_at(then) - 4.0);
        let asked = gain * rate + how.steer * angle;
        filtered += (asked - filtered) * if how.filter_s > 0.0 { PERIOD_S / how.filter_s } else { 1.0 };
        push += 0.05 * (-push + 30.0 * normal());
        // Held for ten samples, so that it moves the steer.
        dither = if k % 10 == 0 { how.dither_nm * normal() } else { dither };
        let torque = filtered + dither;
        let yaw = bicycle.lam.cos() / bicycle.w * (speed * q[1] + bicycle.c * rates[1]);
        let recorded = torque + how.error_nm * normal();
        let error = how.gyro_rad_s * normal();
        rows.push([t, recorded, speed, roll_rate, measured[k][1], q[0], yaw + error]);
        for _ in 0..STEPS {
            let friction = Vector2::new(0.0, how.viscous * rates[1]);
            let stiffness: Matrix2<f64> = linear.k0 * linear.g + linear.k2 * (speed * speed);
            let force = Vector2::new(push, torque) - friction - linear.c1 * rates * speed - stiffness * q;
            rates += inverse * force * (PERIOD_S / STEPS as f64);
            q += rates * (PERIOD_S / STEPS as f64);
        }
    }
    let column = |i: usize| rows.iter().map(|row| row[i]).collect::<Vec<f64>>();
    let channel = |signal, i| Channel { signal, values: column(i) };
    Record {
        times_s: column(0),
        torque_nm: column(1),
        speed_m_s: column(2),
        distance_m: None,
        channels: vec![
            channel(Signal::RollRate, 3),
            channel(Signal::Steer, 4),
            channel(Signal::Roll, 5),
            channel(Signal::YawRate, 6),
        ],
    }
}
