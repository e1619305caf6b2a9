//! The estimator on the sensors of a nonlinear bicycle.

use control::estimate::{EstimateConfig, EstimateState, EstimatorInput, Motion, Place, Source, step};
use proptest::prelude::*;
use sim_host::bicycle::onboard::estimator_parameters;
use sim_host::bicycle::{Geometry, State, Torques, pitch_from_upright};
use sim_host::ride::{Conditions, Start};
use tests::basins::{H, alone, assisted};
use tests::draws::{runner, situations};
use tests::estimator_inputs::{Noise, Truth, ridden, truth};
use tests::rides::{all_shipped, shipped};

const FREE: Torques<f64> = Torques { roll: 0.0, steer: 0.0 };

fn knock(speed_m_s: f64, steer_rate_rad_s: f64) -> Start {
    Start { speed_m_s, steer_rate_rad_s, roll_rate_rad_s: 0.0 }
}

fn jason() -> EstimateConfig {
    EstimateConfig { roll_rate: Source::Estimate, ..estimator_parameters(&alone().bicycle) }
}

/// Properties of the sensors.
#[derive(Clone, Copy, Debug)]
struct Sensors {
    bias: f32,
    noise: Option<u64>,
    accel: bool,
    steer: bool,
    /// Duration of straight riding before \[s\].
    before_s: usize,
}

const EXACT: Sensors = Sensors { bias: 0.0, noise: None, accel: true, steer: true, before_s: 0 };
const REAL: Sensors = Sensors { bias: 0.05, noise: Some(1), before_s: 5, ..EXACT };

/// The largest errors of a ride, and the last motion.
#[derive(Clone, Copy, Debug, Default)]
struct Errors {
    roll: f64,
    roll_rate: f64,
    yaw_rate: f64,
    pitch: f64,
    steer_rate: f64,
    /// Largest roll angle.
    reached: f64,
    /// Least distance between the roll's error and its bound.
    margin: f64,
    last: Motion,
}

/// The estimator on a ride under the law h, evaluated from the disturbance on.
fn estimated(config: &EstimateConfig, sensors: Sensors, start: Start) -> Errors {
    estimated_in(&assisted(H), config, sensors, start)
}

fn estimated_in(conditions: &Conditions, config: &EstimateConfig, sensors: Sensors, start: Start) -> Errors {
    let b = &conditions.bicycle;
    let calm = truth(b, &State::upright(b, start.speed_m_s), &FREE, &config.imu);
    let ride = ridden(conditions, start, &config.imu);
    let before = 1000 * sensors.before_s;
    let mut noise = sensors.noise.map(Noise::new);
    let mut state = EstimateState::default();
    let mut errors = Errors { margin: f64::MAX, ..Errors::default() };
    let pairs = std::iter::repeat_n((calm, calm), before).chain(ride.windows(2).map(|w| (w[0], w[1])));
    for (i, (was, is)) in pairs.enumerate() {
        let mut input = Truth::between(&was, &is).estimator_input(1000);
        if let Some(noise) = &mut noise {
            noise.on(&mut input);
        }
        input.gyro_rad_s[0] += sensors.bias;
        input.accel_m_s2 = input.accel_m_s2.filter(|_| sensors.accel);
        if !sensors.steer {
            (input.steer_rad, input.steer_rate_rad_s) = (None, None);
        }
        let m = step(config, &mut state, &input);
        let e = |estimate: f32, truth: f64| (f64::from(estimate) - truth).abs();
        let roll = e(m.roll_rad, is.roll);
        errors.margin = errors.margin.min(f64::from(m.roll_error.bound_rad()) - roll);
        errors.last = m;
        if i < before {
            continue;
        }
        errors.roll = errors.roll.max(roll);
        errors.roll_rate = errors.roll_rate.max(e(m.roll_rate_rad_s, is.roll_rate));
        errors.yaw_rate = errors.yaw_rate.max(e(m.yaw_rate_rad_s, is.yaw_rate));
        errors.pitch = errors.pitch.max(e(m.pitch_rad, is.pitch));
        errors.steer_rate = errors.steer_rate.max(e(m.steer_rate_rad_s, is.steer_rate));
        errors.reached = errors.reached.max(is.roll.abs());
    }
    errors
}

/// Situation: any attitude and motion of any shipped bicycle, the IMU anywhere in the frame.
/// Action: differentiate the exact motion.
/// Must hold: the estimator's lateral specific force is that of the accelerometer, and its roll and yaw rate follow
/// from the gyro and the pitch.
#[test]
fn the_kinematics_are_exact() {
    let place = Place { forward_m: 0.31, up_m: 0.87 };
    runner(300)
        .run(&situations(1.0), |draw| {
            let b = &draw.geometry;
            let t = truth(b, &draw.state, &draw.torques, &place);
            let ahead = |h: f64| {
                let moved = sim_host::integrate::rk4(b, &draw.state, h, &mut { draw.torques });
                truth(b, &moved, &draw.torques, &place).gyro
            };
            let h = 1e-5;
            let (after, before) = (ahead(h), ahead(-h));
            let turn: [f64; 3] = std::array::from_fn(|i| (after[i] - before[i]) / (2.0 * h));
            let ([wx, wy, wz], (sp, cp)) = (t.gyro, t.pitch.sin_cos());
            let (forward, up) = (f64::from(place.forward_m), f64::from(place.up_m));
            let input = (t.speed - wy * b.rR) * t.yaw_rate * t.roll.cos() - b.g * t.roll.sin()
                + b.rR * t.roll_accel
                + (up - b.rR) * turn[0]
                + forward * turn[2]
                + wy * (wx * forward + wz * (b.rR - up));
            let scale = 1.0 + t.roll_accel.abs() + turn[2].abs();
            prop_assert!((input - t.accel[1]).abs() < 1e-5 * scale, "{} {input} {}", draw.name, t.accel[1]);
            prop_assert!((wx * cp + wz * sp - t.roll_rate).abs() < 1e-9 * scale);
            prop_assert!((wz * cp - wx * sp - t.yaw_rate * t.roll.cos()).abs() < 1e-9 * scale);
            Ok(())
        })
        .unwrap_or_else(|e| panic!("{e}"));
}

/// Situation: every shipped bicycle.
/// Action: compare the fitted pitch with the exact one over the attitudes of ordinary riding.
/// Must hold: it is near, and much better than no pitch at all.
#[test]
fn the_pitch_fits_every_bicycle() {
    for bicycle in all_shipped() {
        let b = Geometry::new(&bicycle.parameters);
        let config = estimator_parameters(&b);
        let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
        for roll in [-0.6, -0.3, 0.0, 0.2, 0.5] {
            for steer in [-0.9, -0.4, 0.0, 0.1, 0.7] {
                let Some(exact) = pitch_from_upright(&b, roll, steer) else { continue };
                let mut state = EstimateState::default();
                let input = EstimatorInput { steer_rad: Some(steer as f32), ..leaning(roll) };
                let mut m = Motion::default();
                for _ in 0..2000 {
                    m = step(&config, &mut state, &input);
                }
                assert!(
                    (f64::from(m.roll_rad) - roll).abs() < 0.02,
                    "{} {roll}: {}",
                    bicycle.name,
                    m.roll_rad
                );
                worst = worst.max((f64::from(m.pitch_rad) - exact).abs());
                largest = largest.max(exact.abs());
            }
        }
        println!("{}: pitch up to {largest:.4}, wrong by up to {worst:.4}", bicycle.name);
        assert!(worst < 0.012 && worst < 0.35 * largest, "{}: {worst} of {largest}", bicycle.name);
        assert!(config.balance.up_m > 0.6 && config.balance.up_m < 1.6, "{:?}", config.balance);
        assert!(config.balance.forward_m > 0.1 && config.balance.forward_m < 0.8, "{:?}", config.balance);
    }
}

/// At rest at a roll angle.
fn leaning(roll: f64) -> EstimatorInput {
    let (s, c) = roll.sin_cos();
    let accel = [0.0, -9.81 * s as f32, -9.81 * c as f32];
    EstimatorInput { accel_m_s2: Some(accel), elapsed_us: 1000, ..EstimatorInput::default() }
}

/// Situation: rides inside the basin of h and at its border, exact sensors.
/// Action: estimate from the first instant.
/// Must hold: roll angle, rates and pitch are right except for the error of the pitch's fit.
#[test]
fn exact_sensors_give_the_exact_motion() {
    let config = jason();
    for (v, kick) in [(2.0, 0.5), (2.0, 7.3), (3.5, 4.0), (5.0, 8.2), (7.5, 2.0), (7.5, 7.0)] {
        let e = estimated(&config, EXACT, knock(v, kick));
        println!("{v} m/s, {kick} rad/s: {e:?}");
        assert!(e.roll < 0.006 && e.roll > 1e-6, "{v} {kick}: {}", e.roll);
        assert!(e.roll_rate < 0.04, "{v} {kick}: {}", e.roll_rate);
        assert!(e.yaw_rate < 0.02, "{v} {kick}: {}", e.yaw_rate);
        assert!(e.pitch < 0.012, "{v} {kick}: {}", e.pitch);
        assert!(e.margin > 0.03 && e.reached > 2.0 * e.roll, "{v} {kick}");
    }
}

/// Situation: the same rides with a gyro bias of 0.05 rad/s and the noise of a consumer IMU, after five seconds of
/// straight riding.
/// Action: estimate.
/// Must hold: the bias is found, the roll angle is good, the stated bound covers its error and is no more than a few
/// times the necessary one.
#[test]
fn bias_and_noise_leave_a_useful_roll_angle() {
    let config = jason();
    for seed in 1..=5 {
        for (v, kick) in [(2.0, 0.5), (2.0, 7.3), (3.5, 4.0), (5.0, 8.2), (7.5, 2.0), (7.5, 7.0)] {
            let e = estimated(&config, Sensors { noise: Some(seed), ..REAL }, knock(v, kick));
            println!("{v} m/s, {kick} rad/s: {e:?}");
            assert!((0.003..0.06).contains(&e.roll), "{v} {kick}: {}", e.roll);
            assert!((0.05..0.35).contains(&e.roll_rate), "{v} {kick}: {}", e.roll_rate);
            assert!((f64::from(e.last.gyro_bias_rad_s[0]) - 0.05).abs() < 0.01, "{:?}", e.last);
            assert!(e.margin > 0.0, "{v} {kick}: {}", e.margin);
            assert!(e.last.roll_error.bound_rad() < 0.15, "{v} {kick}: {}", e.last.roll_error.bound_rad());
        }
    }
}

/// Situation: the same without accelerometer, and without steer sensor.
/// Action: estimate.
/// Must hold: both cost accuracy, neither breaks it, and the bound still covers the error.
#[test]
fn fewer_sensors_widen_the_error_bound() {
    let config = jason();
    for (v, kick) in [(2.0, 7.3), (3.5, 4.0), (5.0, 8.2), (7.5, 7.0)] {
        let whole = estimated(&config, REAL, knock(v, kick));
        let rates = estimated(&config, Sensors { accel: false, ..REAL }, knock(v, kick));
        let straight = estimated(&config, Sensors { steer: false, ..REAL }, knock(v, kick));
        println!("{v} {kick}: {whole:?} {rates:?} {straight:?}");
        assert!(rates.roll < 0.1 && rates.margin > 0.0, "{v} {kick}: {rates:?}");
        assert!(rates.last.roll_error.bound_rad() > whole.last.roll_error.bound_rad() + 0.05, "{v} {kick}");
        assert!(straight.roll < 0.12 && straight.margin > 0.0, "{v} {kick}: {straight:?}");
        assert!(straight.last.pitch_rad == 0.0 && straight.last.steer_rad == 0.0, "{v} {kick}");
    }
}

/// Situation: standing, without accelerometer, nothing that shows the roll angle.
/// Action: wait.
/// Must hold: the bound only grows, until it contains every angle.
#[test]
fn without_measurements_the_bound_grows() {
    let config = jason();
    let conditions = assisted(H);
    let b = &conditions.bicycle;
    let mut state = EstimateState::default();
    let riding = truth(b, &State::upright(b, 4.0), &FREE, &config.imu).estimator_input(1000);
    let mut bound = f32::MAX;
    for _ in 0..3000 {
        bound = step(&config, &mut state, &riding).roll_error.bound_rad();
    }
    assert!(bound < 0.15, "{bound}");
    let blind = EstimatorInput { accel_m_s2: None, speed_m_s: 0.5, ..riding };
    let mut last = 0.0;
    for i in 0..120_000 {
        let now = step(&config, &mut state, &blind).roll_error.bound_rad();
        assert!(now >= last || i == 0, "{i}: {last} {now}");
        last = now;
    }
    assert!(last > 1.0, "{last}");
}

/// Situation: standing still before the ride, every gyro axis with a bias.
/// Action: wait two seconds.
/// Must hold: all three biases are found; with a gyro that moves more than any bias none is found.
#[test]
fn standing_still_shows_every_bias() {
    let config = jason();
    let found = |gyro: [f32; 3]| {
        let mut state = EstimateState::default();
        let input = EstimatorInput { gyro_rad_s: gyro, ..leaning(0.1) };
        (0..4000).map(|_| step(&config, &mut state, &input)).last().expect("steps")
    };
    let expected = [0.04, -0.02, 0.03];
    let m = found(expected);
    for (bias, expected) in m.gyro_bias_rad_s.iter().zip(expected) {
        assert!((bias - expected).abs() < 0.002, "{:?}", m.gyro_bias_rad_s);
    }
    assert!((m.roll_rad - 0.1).abs() < 0.01 && m.roll_rate_rad_s.abs() < 0.002, "{m:?}");
    assert_eq!(found([0.0, 0.0, 0.2]).gyro_bias_rad_s[1..], [0.0, 0.0]);
}

/// Situation: a steer angle that sweeps at a constant rate, from an encoder of 13 bits.
/// Action: estimate the rate from the angle alone, from both, from the rate alone.
/// Must hold: the lag is the stated one, the quantisation small, and with a rate sensor there is no lag.
#[test]
fn steer_rate_of_an_encoder() {
    let config = EstimateConfig { steer_lag_s: 0.01, ..jason() };
    let count = std::f64::consts::TAU / 8192.0;
    let run = |angle: bool, rate: bool| {
        let mut state = EstimateState::default();
        let mut worst = (0.0_f64, 0.0_f64);
        for i in 0..2000 {
            let t = f64::from(i) * 1e-3;
            let (at, turns) = (0.4 * (6.0 * t).sin(), |t: f64| 2.4 * (6.0 * t).cos());
            let steer_rad = angle.then_some(((at / count).round() * count) as f32);
            let input = EstimatorInput {
                steer_rad,
                steer_rate_rad_s: rate.then_some(turns(t) as f32 + 0.1),
                speed_m_s: 4.0,
                elapsed_us: 1000,
                ..EstimatorInput::default()
            };
            let m = step(&config, &mut state, &input);
            if i > 500 {
                let error = |at: f64| (f64::from(m.steer_rate_rad_s) - at).abs();
                worst = (worst.0.max(error(turns(t))), worst.1.max(error(turns(t - 0.01))));
            }
        }
        worst
    };
    let (now, late) = run(true, false);
    println!("angle alone: {now:.3} rad/s off, {late:.3} from 10 ms ago");
    assert!((0.08..0.2).contains(&now) && late < 0.06, "{now} {late}");
    let (fused, _) = run(true, true);
    assert!(fused < 0.04, "{fused}");
    let (rate, _) = run(false, true);
    assert!((rate - 0.1).abs() < 0.001, "{rate}");
}

/// Situation: the published conditions, roll rate by the gyro's x axis.
/// Action: any finite gyro value.
/// Must hold: the output has the same bits.
#[test]
fn the_gyro_passes_with_unchanged_bits() {
    let config = EstimateConfig::default();
    let mut state = EstimateState::default();
    let (mut bits, mut passed) = (0_u32, 0);
    while passed < 20_000 {
        bits = bits.wrapping_add(0x0004_9e4d);
        let x = f32::from_bits(bits);
        if x.is_finite() {
            let input = EstimatorInput {
                gyro_rad_s: [x, 0.1, -0.2],
                speed_m_s: 4.0,
                elapsed_us: 1000,
                ..EstimatorInput::default()
            };
            assert_eq!(step(&config, &mut state, &input).roll_rate_rad_s.to_bits(), bits);
            passed += 1;
        }
    }
}

fn any_float() -> impl Strategy<Value = f32> {
    prop_oneof![any::<u32>().prop_map(f32::from_bits), -3.0_f32..3.0]
}

fn any_input() -> impl Strategy<Value = EstimatorInput> {
    let three = || [any_float(), any_float(), any_float()];
    let sometimes = |s| proptest::option::of(s);
    let elapsed = prop_oneof![Just(1000_u32), any::<u32>(), 0_u32..20_000];
    (
        three(),
        sometimes(three()),
        proptest::option::of(any_float()),
        proptest::option::of(any_float()),
        any_float(),
        elapsed,
    )
        .prop_map(|(gyro_rad_s, accel_m_s2, steer_rad, steer_rate_rad_s, speed_m_s, elapsed_us)| {
            EstimatorInput { gyro_rad_s, accel_m_s2, steer_rad, steer_rate_rad_s, speed_m_s, elapsed_us }
        })
}

fn numbers(m: &Motion) -> [f32; 12] {
    let [bx, by, bz] = m.gyro_bias_rad_s;
    [
        m.roll_rad,
        m.roll_rate_rad_s,
        m.yaw_rate_rad_s,
        m.steer_rad,
        m.steer_rate_rad_s,
        m.roll_accel_rad_s2,
        bx,
        bz,
        by,
        m.pitch_rad,
        m.speed_m_s,
        m.roll_error.bound_rad(),
    ]
}

proptest! {
    /// Situation: any inputs, for a while.
    /// Action: step.
    /// Must hold: every number is finite, the roll angle within a quarter turn, the bound between zero and its
    /// maximum.
    #[test]
    fn every_motion_is_finite(sequence in proptest::collection::vec(any_input(), 1..60), own in any::<bool>()) {
        let config = if own { jason() } else { EstimateConfig::default() };
        let mut state = EstimateState::default();
        for input in sequence {
            let m = step(&config, &mut state, &input);
            prop_assert!(numbers(&m).iter().all(|x| x.is_finite()), "{input:?} {m:?}");
            prop_assert!(m.roll_rad.abs() <= std::f32::consts::FRAC_PI_2);
            prop_assert!((0.0..=std::f32::consts::PI).contains(&m.roll_error.bound_rad()));
        }
    }

    /// Situation: any motion and its mirror image.
    /// Action: step both.
    /// Must hold: all lateral quantities change their sign, all others are equal, to the bit.
    #[test]
    fn left_mirrors_right(sequence in proptest::collection::vec(any_input(), 1..60)) {
        let config = jason();
        let (mut right, mut left) = (EstimateState::default(), EstimateState::default());
        for input in sequence {
            let [x, y, z] = input.gyro_rad_s;
            let mirrored = EstimatorInput {
                gyro_rad_s: [-x, y, -z],
                accel_m_s2: input.accel_m_s2.map(|[x, y, z]| [x, -y, z]),
                steer_rad: input.steer_rad.map(|s| -s),
                steer_rate_rad_s: input.steer_rate_rad_s.map(|s| -s),
                ..input
            };
            let (r, l) = (step(&config, &mut right, &input), step(&config, &mut left, &mirrored));
            for (i, (a, b)) in numbers(&r).into_iter().zip(numbers(&l)).enumerate() {
                let b = if i < 8 { -b } else { b };
                prop_assert!(a == b, "{i}: {a} {b}");
            }
        }
    }
}

/// Situation: a gap in time longer than the estimator bridges.
/// Action: step.
/// Must hold: the roll angle is unknown again, the biases found at standstill are unchanged.
#[test]
fn a_gap_makes_the_roll_angle_unknown() {
    let config = jason();
    let b = Geometry::new(&shipped("rigid_jason").parameters);
    let riding = truth(&b, &State::upright(&b, 4.0), &FREE, &config.imu).estimator_input(1000);
    let mut state = EstimateState::default();
    let before = (0..2000).map(|_| step(&config, &mut state, &riding)).last().expect("steps");
    let after = step(
        &config,
        &mut state,
        &EstimatorInput { elapsed_us: 200_000, accel_m_s2: None, speed_m_s: 0.0, ..riding },
    );
    assert!(
        before.roll_error.bound_rad() < 0.2 && after.roll_error.bound_rad() > 2.0,
        "{before:?} {after:?}"
    );
}
