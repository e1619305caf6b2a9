//! Sensor frames and configurations as input of the images.

use control::law::capsize::Capsize;
use control::law::gain_schedule::TABLE_POINTS;
use control::law::path_tracking::PathTracking;
use control::safety::limits::SpeedCap;
use control::sensors::latency::{Latency, MAX_LATENCY_TICKS};
use control::wire::{decode_frame, encode_config, encode_frame};
use control::{Config, GainSchedule, Law, Sample, Sensor, SensorFrame, Triple, Wheel};
use std::f32::consts::TAU;

/// [`border_ride`], recorded.
const BORDER_RIDE: &[u8] = include_bytes!("../../data/border_ride.frames");

/// [`all_sensors_ride`], recorded.
const ALL_SENSORS_RIDE: &[u8] = include_bytes!("../../data/all_sensors.frames");

/// Configurations with names: every law without limits, the product, and sensors of different latency.
///
/// # Panics
/// Never: the table is valid.
pub fn configurations() -> Vec<(&'static str, Config)> {
    let points: Vec<_> =
        (0_u8..TABLE_POINTS as u8).map(|i| (0.25 * f32::from(i), 31.5 - f32::from(i))).collect();
    let table = GainSchedule::new(&points).expect("a valid table");
    let late = |roll_rate_ticks, speed_ticks, config| Config {
        latency: Latency { roll_rate_ticks, speed_ticks },
        ..config
    };
    let product = product();
    let rear = Config { input: product.input.scheduled_by(Wheel::Rear), ..product.clone() };
    vec![
        ("none", Config::thesis(Law::None)),
        ("h", Config::thesis(Law::H { cut: false })),
        ("h, cut", Config::thesis(Law::H { cut: true })),
        ("f", Config::thesis(Law::F)),
        ("g", Config::thesis(Law::G)),
        ("cl1", Config::thesis(Law::Cl1)),
        ("cl2, k = 3.7", Config::thesis(Law::Cl2 { k: 3.7 })),
        ("balance assist, kappa = 5.2", Config::thesis(Law::BalanceAssist { kappa: 5.2 })),
        ("table of 32 points", Config::thesis(Law::Table(table))),
        ("h, gyro 31 ticks late", late(MAX_LATENCY_TICKS, 0, Config::thesis(Law::H { cut: false }))),
        ("product", product),
        ("product, rear wheel, wheel 20 ticks late", late(2, 20, rear)),
    ]
}

/// The flashed configuration, on a bicycle with a passed polarity check.
pub fn product() -> Config {
    let mut product = Config::product();
    product.calibration.polarity_checked = true;
    product
}

/// The product with everything on that is off in it: the dead band, the capsize term, the lead, path tracking, a rider torque sensor,
/// a torque limit over speed, sensors of different latency.
pub fn everything() -> Config {
    let mut config = product();
    config.dead_band.roll_rate_rad_s = 0.02;
    config.capsize = Capsize { k_c: 1.0, v_max_m_s: 2.0 };
    config.predict.lead_s = 0.02;
    config.track = Some(PathTracking::default());
    config.input.rider_torque = config.input.steer;
    config.input.rider_torque.max = 50.0;
    config.input.path = Sensor::exact(10.0);
    config.limits.speed_cap = Some(SpeedCap::default());
    config.latency = Latency { roll_rate_ticks: 2, speed_ticks: 5 };
    config
}

/// A ride at the border of the basin: law h, 4 m/s, initial steer rate 8.42 rad/s, 6 s at 1 kHz, every sample fresh.
/// Recorded with `sim-host ride --speed 4 --steer-rate 8.42 --frames data/border_ride.frames`; a test reproduces it.
///
/// # Panics
/// Never: the file is a whole number of frames.
pub fn border_ride() -> Vec<SensorFrame> {
    let (frames, rest) = BORDER_RIDE.as_chunks();
    assert!(rest.is_empty(), "data/border_ride.frames ends in half a frame");
    frames.iter().map(decode_frame).collect()
}

/// A ride with the flashed configuration and every sensor that it declares, including boot and engagement: 4 m/s,
/// initial steer rate 5 rad/s, 1.25 s at 1 kHz. Recorded with `sim-host ride --preset product --speed 4 --steer-rate 5
/// --time-limit 1.25 --frames data/all_sensors.frames`; a test reproduces it. Rider torque and path are synthetic.
///
/// # Panics
/// Never: the file is a whole number of frames.
pub fn all_sensors_ride() -> Vec<SensorFrame> {
    let (frames, rest) = ALL_SENSORS_RIDE.as_chunks();
    assert!(rest.is_empty(), "data/all_sensors.frames ends in half a frame");
    // Rider torque and path, which the flashed configuration does not use.
    let complete = |frame: SensorFrame| SensorFrame {
        rider_torque_nm: Sample::fresh(10.0 * frame.steer_rad.value),
        heading_error_rad: Sample::fresh(frame.steer_rad.value),
        lateral_error_m: Sample::fresh(0.5 + frame.steer_rad.value),
        ..frame
    };
    frames.iter().map(decode_frame).map(complete).collect()
}

/// [`all_sensors_ride`] with, from its middle on, each sensor in turn lost, not a number, or out of range, the clock
/// jumping, the switch released, or the bicycle upside down.
pub fn broken_rides() -> Vec<Vec<SensorFrame>> {
    let breaks: [fn(&mut SensorFrame); 19] = [
        |f| f.gyro_rad_s = Triple::missing(),
        |f| f.gyro_rad_s.value[0] = f32::NAN,
        |f| f.gyro_rad_s.value[2] = 50.0,
        |f| f.accel_m_s2 = Triple::missing(),
        |f| f.accel_m_s2.value[1] = 500.0,
        |f| f.steer_rad = Sample::missing(),
        |f| f.steer_rad.value = f32::NAN,
        |f| f.steer_rate_rad_s = Sample::missing(),
        |f| f.steer_rate_rad_s.value = -f.steer_rate_rad_s.value,
        |f| f.front_wheel_m_s = Sample::missing(),
        |f| f.front_wheel_m_s.value *= 0.5,
        |f| f.front_wheel_m_s.age_ticks = 60,
        |f| f.rear_wheel_m_s = Sample::missing(),
        |f| f.rear_wheel_m_s.value += 2.0,
        |f| f.motor_torque_nm = Sample::missing(),
        |f| f.motor_torque_nm.value = 5.0,
        |f| f.now_us = f.now_us.wrapping_mul(7),
        |f| f.engage = false,
        |f| f.accel_m_s2.value = f.accel_m_s2.value.map(|x| -x),
    ];
    let broken = |change: fn(&mut SensorFrame)| {
        let mut ride = all_sensors_ride();
        let middle = ride.len() / 2;
        ride.iter_mut().skip(middle).for_each(change);
        ride
    };
    breaks.into_iter().map(broken).collect()
}

/// A ride in which every sensor has a sample only once in `periods` periods, all in the same one.
pub fn held(ride: &[SensorFrame], periods: u16) -> Vec<SensorFrame> {
    let aged = |age: u16, by: usize| age.saturating_add(by as u16);
    ride.chunks(usize::from(periods))
        .flat_map(|chunk| chunk.iter().enumerate().map(move |(by, frame)| (by, frame, chunk[0])))
        .map(|(by, frame, first)| {
            let triple = |of: Triple| Triple { age_ticks: aged(of.age_ticks, by), ..of };
            let sample = |of: Sample| Sample { age_ticks: aged(of.age_ticks, by), ..of };
            SensorFrame {
                now_us: frame.now_us,
                gyro_rad_s: triple(first.gyro_rad_s),
                accel_m_s2: triple(first.accel_m_s2),
                steer_rad: sample(first.steer_rad),
                steer_rate_rad_s: sample(first.steer_rate_rad_s),
                front_wheel_m_s: sample(first.front_wheel_m_s),
                rear_wheel_m_s: sample(first.rear_wheel_m_s),
                rider_torque_nm: sample(first.rider_torque_nm),
                motor_torque_nm: sample(first.motor_torque_nm),
                heading_error_rad: sample(first.heading_error_rad),
                lateral_error_m: sample(first.lateral_error_m),
                engage: frame.engage,
            }
        })
        .collect()
}

/// A synthetic ride over a wide range: 20 s at 1 kHz, roll rate of growing amplitude while the speed falls from 8 to 1
/// m/s, then decaying as the speed rises again. The wheel's pulses come every 20 ms.
pub fn swinging_ride() -> Vec<SensorFrame> {
    let mut speed = 8.0;
    (0_u16..20_000)
        .map(|tick| {
            let t = f32::from(tick) * 1e-3;
            let size = 0.2 * (0.35 * (10.0 - (t - 10.0).abs())).exp();
            if tick % 20 == 0 {
                speed = 1.0 + 0.7 * (t - 10.0).abs();
            }
            let wheel_speed_m_s = Sample { value: speed, age_ticks: tick % 20 };
            let roll_rate = size * (0.8 * TAU * t).sin();
            SensorFrame {
                now_us: u32::from(tick) * 1000,
                gyro_rad_s: Triple::fresh([roll_rate, 0.0, 0.0]),
                front_wheel_m_s: wheel_speed_m_s,
                rear_wheel_m_s: wheel_speed_m_s,
                engage: tick > 400,
                ..SensorFrame::missing()
            }
        })
        .collect()
}

/// The ride with every sample fresh, as the published laws require.
pub fn fresh(ride: &[SensorFrame]) -> Vec<SensorFrame> {
    let fresh = |sample: Sample| Sample { age_ticks: 0, ..sample };
    ride.iter()
        .map(|f| SensorFrame {
            front_wheel_m_s: fresh(f.front_wheel_m_s),
            rear_wheel_m_s: fresh(f.rear_wheel_m_s),
            ..*f
        })
        .collect()
}

/// Pseudo-random frames: intervals of plausible, fresh frames, in which the law runs, alternate with arbitrary ones:
/// every bit pattern, the edges of the ranges, late and missing samples. The switch is pressed five times a second,
/// since a rejected press has no later effect.
pub fn random_frames(seed: u64, frames: usize) -> Vec<SensorFrame> {
    let mut random = Random(seed);
    let (mut calm, mut switch, mut now_us) = (0, 0, 0_u32);
    let mut walks = [0.0; 14];
    (0..frames)
        .map(|_| {
            calm = if calm == 0 { random.below(2000) } else { calm - 1 };
            switch = if switch == 0 { random.below(400) } else { switch - 1 };
            let wild = calm < 40 && random.below(3) == 0;
            now_us = now_us.wrapping_add(if wild { random.next() as u32 } else { 1000 });
            for (walk, reach) in walks.iter_mut().zip(REACH) {
                *walk = random.walked(*walk, reach);
            }
            let [p, q, r, x, y, z, steer, steer_rate, front, rear, rider, motor, heading, lateral] =
                walks.map(|walk| random.sample(wild, walk));
            let triple = |x: Sample, y: Sample, z: Sample| Triple {
                value: [x.value, y.value, z.value],
                age_ticks: x.age_ticks,
            };
            SensorFrame {
                now_us,
                gyro_rad_s: triple(p, q, r),
                accel_m_s2: triple(x, y, z),
                steer_rad: steer,
                steer_rate_rad_s: steer_rate,
                front_wheel_m_s: front,
                rear_wheel_m_s: rear,
                rider_torque_nm: rider,
                motor_torque_nm: motor,
                heading_error_rad: heading,
                lateral_error_m: lateral,
                engage: switch > 3,
            }
        })
        .collect()
}

/// Range of the plausible values, in the order of the frame.
const REACH: [f32; 14] = [6.0, 2.0, 4.0, 3.0, 6.0, 12.0, 1.0, 10.0, 12.0, 12.0, 8.0, 1.5, 0.5, 2.0];

/// The content of `rides.bin` for these rides.
pub fn encode(rides: &[(&Config, &[SensorFrame])]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (config, frames) in rides {
        bytes.extend(encode_config(config));
        bytes.extend((frames.len() as u32).to_le_bytes());
        frames.iter().for_each(|frame| bytes.extend(encode_frame(frame)));
    }
    bytes
}

/// Values at which f32 arithmetic or the input checks change their behaviour.
const EDGES: [u32; 20] = [
    0x0000_0000, // 0
    0x8000_0000, // -0
    0x0000_0001, // least denormal
    0x8000_0001,
    0x007f_ffff, // largest denormal
    0x0080_0000, // least normal
    0x8080_0000,
    0x7f7f_ffff, // largest
    0xff7f_ffff,
    0x7f80_0000, // infinite
    0xff80_0000,
    0x7fc0_0000, // quiet NaN
    0xffc0_1234,
    0x7f80_0001, // signalling NaN
    0xffbf_ffff,
    0x4270_0000, // 60, the largest roll rate
    0x4270_0001,
    0x41f0_0000, // 30, the largest speed
    0x41f0_0001,
    0x40f0_0000, // 7.5, where h is cut
];

/// SplitMix64 (Steele, Lea and Flood 2014): small, and identical on all machines.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: u32) -> u32 {
        (self.next() >> 32) as u32 % end
    }

    /// A step of a random walk within `reach` in both directions.
    fn walked(&mut self, from: f32, reach: f32) -> f32 {
        let step = (self.below(1 << 24) as f32 / (1 << 23) as f32 - 1.0) * 0.004 * reach;
        (from + step).clamp(-reach, reach)
    }

    /// The `plausible` value, fresh, or an arbitrary one if `wild`.
    fn sample(&mut self, wild: bool, plausible: f32) -> Sample {
        let within = plausible;
        if !wild {
            return Sample::fresh(within);
        }
        let value = match self.below(4) {
            0 => f32::from_bits(self.next() as u32),
            1 => f32::from_bits(EDGES[self.below(EDGES.len() as u32) as usize]),
            2 => f32::from_bits(0x7f80_0000 | self.next() as u32),
            _ => within,
        };
        let age = match self.below(6) {
            0 => self.below(20),
            1 => 240 + self.below(20),
            2 => self.below(1 << 16),
            3 => u32::from(control::sensors::frame::MISSING),
            _ => 0,
        };
        Sample { value, age_ticks: age as u16 }
    }
}
