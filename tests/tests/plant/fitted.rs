//! Errors as fitted to recordings, simulated in a sensor and estimated again from its output.

use sim_host::plant::sensor_file::{MeasuredNumber, SensorNumbers};
use sim_host::plant::{FittedErrors, Plant, Reading, Sensor, SensorModel, SensorSuite};
use sim_host::replay::{Sample, Samples, Track};
use sim_host::ride::Start;
use sim_host::sensor_fit::{Recording, fit};
use std::f64::consts::TAU;

const START: Start = Start { speed_m_s: 0.0, steer_rate_rad_s: 5.0, roll_rate_rad_s: 0.0 };

/// The samples that arrive of `sensors` for `ticks` periods of 1 ms, where the true value is `truth(t)` \[s\].
fn arrived(
    models: &[(Sensor, SensorModel)],
    seed: u64,
    ticks: i64,
    truth: impl Fn(f64) -> Reading,
) -> Vec<Track> {
    let mut plant = Plant { seed, ..Plant::default() };
    for (sensor, model) in models {
        *plant.sensors.model_mut(*sensor) = *model;
    }
    plant.check().expect("in range");
    let mut sensors = SensorSuite::new(&plant, 1e-3, &START, &truth(0.0));
    let track = |(sensor, _): &(Sensor, SensorModel)| Track {
        sensor: *sensor,
        samples: Vec::new(),
        made_up: [false; 3],
    };
    let mut tracks: Vec<Track> = models.iter().map(track).collect();
    for tick in 0..ticks {
        let t_s = tick as f64 * 1e-3;
        let measured = sensors.measure(&plant, &truth(t_s), true);
        for track in &mut tracks {
            let held = measured.of(track.sensor);
            if held.age_ticks == 0 {
                track.samples.push(Sample { t_s, value: held.value });
            }
        }
    }
    tracks
}

fn values(model: FittedErrors, sensor: Sensor, ticks: i64, truth: impl Fn(f64) -> Reading) -> Vec<Sample> {
    let model = SensorModel { fitted: model, ..SensorModel::default() };
    arrived(&[(sensor, model)], 0, ticks, truth).remove(0).samples
}

fn rides(speed_m_s: f64) -> Reading {
    Reading::steady(speed_m_s, 9.81)
}

/// Situation: a wheel whose speed is a mean over 50 ms, and rises by 1 m/s each second.
/// Must hold: 24.5 ms late, to a rounding, once the mean is full.
#[test]
fn a_mean_is_late_by_half_of_it() {
    let model = FittedErrors { window_ticks: 50, ..FittedErrors::default() };
    for sample in values(model, Sensor::RearWheel, 300, rides).iter().skip(50) {
        assert!((sample.value[0] - (sample.t_s - 0.0245)).abs() < 1e-9, "{sample:?}");
    }
}

/// Situation: a wheel with 16 pulses a turn, steady at 0.3 to 8 m/s, and one at rest.
/// Must hold: the speed to 0.2 % once two pulses came, and zero at rest.
#[test]
fn pulses_give_a_steady_speed() {
    let model = FittedErrors { pulses_per_turn: 16, ..FittedErrors::default() };
    for speed in [0.0, 0.3, 1.0, 3.3, 8.0] {
        let output = values(model, Sensor::FrontWheel, 3000, |_| rides(speed));
        for sample in &output[1500..] {
            assert!((sample.value[0] - speed).abs() <= 2e-3 * speed, "{speed}: {sample:?}");
        }
    }
}

/// Situation: samples each 10 ms, 4 ms after the whole multiples, late by up to 3 ms in 99 of 100 and 20 ms at worst.
/// Must hold: none early, none later than that, in their order; the fraction later than 3 ms is the declared one.
#[test]
fn lateness_has_its_distribution() {
    let fitted = FittedErrors { phase_ticks: 4, jitter_ticks: [3, 20], ..FittedErrors::default() };
    let model = SensorModel { every_ticks: 10, fitted, ..SensorModel::default() };
    let clock = |t: f64| Reading { steer_rad: t, ..rides(4.0) };
    let samples = arrived(&[(Sensor::Steer, model)], 3, 200_000, clock).remove(0).samples;
    assert!(samples.windows(2).all(|two| two[0].value[0] < two[1].value[0]));
    let late: Vec<i64> = samples.iter().map(|s| ((s.t_s - s.value[0]) * 1e3).round() as i64).collect();
    assert!(samples.iter().all(|s| (s.value[0] * 1e3).round() as i64 % 10 == 4));
    assert!(late.iter().all(|late| (0..=20).contains(late)));
    let count = |from: i64| late.iter().filter(|late| **late > from).count() as f64 / late.len() as f64;
    assert!((0.004..0.016).contains(&count(3)), "{}", count(3));
    assert!((0.21..0.29).contains(&count(2)), "{}", count(2));
}

/// Situation: vibration of 0.01 rad/s for 1 m/s in the octave from 20 Hz, at 0, 2 and 4 m/s.
/// Must hold: none at standstill; twice as much at twice the speed; of its power less than 1 % below 18 Hz.
#[test]
fn vibration_grows_with_the_speed_and_keeps_its_octave() {
    let vibration = [[0.0, 0.01, 0.0, 0.0], [0.0; 4], [0.0; 4]];
    let model = FittedErrors { vibration, ..FittedErrors::default() };
    let rms = |speed: f64| {
        let output = values(model, Sensor::Gyro, 20_000, |_| rides(speed));
        assert!(output.iter().all(|sample| sample.value[1] == 0.0 && sample.value[2] == 0.0));
        let slow: Vec<f64> =
            output.windows(100).map(|w| w.iter().map(|s| s.value[0]).sum::<f64>() / 100.0).collect();
        let square = |values: &mut dyn Iterator<Item = f64>, n: usize| {
            (values.map(|x| x * x).sum::<f64>() / n as f64).sqrt()
        };
        let all = square(&mut output.iter().map(|sample| sample.value[0]), output.len());
        // A mean over 100 ms passes at most 5 % of 20 Hz and more, and 90 % of 3 Hz.
        assert!(square(&mut slow.iter().copied(), slow.len()) <= 0.1 * all);
        all
    };
    assert_eq!(rms(0.0), 0.0);
    let (two, four) = (rms(2.0), rms(4.0));
    assert!((two / 0.02 - 1.0).abs() < 0.03 && (four / two - 2.0).abs() < 1e-9, "{two} {four}");
}

/// The first and the last sample of a ride.
type Ends = ([f64; 3], [f64; 3]);

/// Situation: a bias of 0.02 rad/s from ride to ride, and a random walk of 0.001 rad/s by the root of a second, in
/// 400 rides of 4 s.
/// Must hold: both standard deviations within five standard errors, by axis; the axes are uncorrelated.
#[test]
fn bias_differs_from_ride_to_ride_and_wanders() {
    let fitted = FittedErrors { bias_spread: [0.02; 3], walk: [1e-3; 3], ..FittedErrors::default() };
    let model = SensorModel { every_ticks: 10, fitted, ..SensorModel::default() };
    let ends = |seed: u64| {
        let output = arrived(&[(Sensor::Gyro, model)], seed, 4001, |_| rides(3.0)).remove(0).samples;
        (output[0].value, output[output.len() - 1].value)
    };
    let all: Vec<Ends> = (0..400).map(ends).collect();
    let spread = |of: &dyn Fn(&Ends) -> f64| (all.iter().map(|x| of(x).powi(2)).sum::<f64>() / 400.0).sqrt();
    let near = |found: f64, truth: f64| (found / truth - 1.0).abs() < 5.0 / 800.0_f64.sqrt();
    for axis in 0..3 {
        let (first, wandered) = (spread(&|x| x.0[axis]), spread(&|x| x.1[axis] - x.0[axis]));
        assert!(near(first, 0.02) && near(wandered, 2e-3), "{axis}: {first} {wandered}");
    }
    let together = all.iter().map(|x| x.0[0] * x.0[1]).sum::<f64>() / 400.0;
    assert!(together.abs() < 5.0 * 0.02 * 0.02 / 20.0, "{together}");
}

/// Standing for 60 s, riding at 2, 3 and 4 m/s for 15 s each with slow motion, standing for 30 s.
fn reading_at(t_s: f64) -> Reading {
    let speed = match t_s {
        t if !(60.0..105.0).contains(&t) => 0.0,
        t => 2.0 + ((t - 60.0) / 15.0).floor(),
    };
    let sway = |amplitude: f64, hz: f64| if speed > 0.0 { amplitude * (TAU * hz * t_s).sin() } else { 0.0 };
    Reading {
        gyro_rad_s: [sway(0.2, 0.8), sway(0.05, 1.3), sway(0.3, 0.6)],
        steer_rad: sway(0.1, 0.7),
        ..rides(speed)
    }
}

/// Recordings of the output of sensors of these models, each with other random numbers.
fn recordings(models: &[(Sensor, SensorModel)], seeds: u64) -> Vec<Recording> {
    let wheel = (Sensor::RearWheel, SensorModel { every_ticks: 10, ..SensorModel::default() });
    let models = [models, &[wheel]].concat();
    let one = |seed| {
        let samples = Samples { tracks: arrived(&models, seed, 135_000, reading_at), ..Samples::default() };
        Recording { samples, distance_m: Vec::new() }
    };
    (0..seeds).map(one).collect()
}

fn number<'a>(found: &'a SensorNumbers, name: &str, axis: &str) -> &'a MeasuredNumber {
    let fits = |m: &&MeasuredNumber| m.number.starts_with(name) && m.axis == axis;
    found.measured.iter().find(fits).unwrap_or_else(|| panic!("{name} {axis}: {found:?}"))
}

/// Situation: three rides, each with standstill before and after, by a gyro with noise, a random walk, a bias and
/// vibration of known size in steps of 0.5 mrad/s at 200 Hz.
/// Action: fit a model to its output.
/// Must hold: of the 21 numbers at least 18 inside their 95 % intervals and none further out than their width; no
/// interval is wider than its number, except the bias' of three rides and the walk's; step and period are the
/// simulated ones.
#[test]
fn simulated_errors_are_estimated() {
    let truth = FittedErrors {
        white: [2e-3, 3e-3, 4e-3],
        walk: [4e-4, 5e-4, 6e-4],
        bias_spread: [0.01, 0.02, 0.01],
        vibration: [[2e-3, 1e-3, 2e-3, 1e-3], [6e-3, 2e-3, 1e-3, 2e-3], [3e-3, 3e-3, 2e-3, 1e-3]],
        quantum: [5e-4; 3],
        ..FittedErrors::default()
    };
    let model = SensorModel { every_ticks: 5, fitted: truth, ..SensorModel::default() };
    let found = fit(Sensor::Gyro, &recordings(&[(Sensor::Gyro, model)], 3)).expect("a model");
    assert_eq!((found.period_s, &found.quantum[..]), (Some(0.005), &[5e-4; 3][..]));
    let (mut inside, mut numbers) = (0, 0);
    let mut check = |name: &str, axis: usize, truth: f64, widest: f64| {
        let m = number(&found, name, ["x", "y", "z"][axis]);
        let width = m.high - m.low;
        println!("{name} {axis}: {truth:.3e} in {:.3e} to {:.3e}, {}", m.low, m.high, m.value);
        assert!((m.low - width..=m.high + width).contains(&truth), "{truth}: {m:?}");
        assert!(width > 0.0 && width < widest * truth, "{truth}: {m:?}");
        numbers += 1;
        inside += usize::from((m.low..=m.high).contains(&truth));
    };
    for axis in 0..3 {
        // Rounding adds the noise of a step.
        let power = truth.white[axis].powi(2) + truth.quantum[axis].powi(2) / 12.0;
        check("white noise, standing", axis, (2.0 * 0.005 * power).sqrt(), 0.2);
        check("walk of the bias", axis, truth.walk[axis], 2.0);
        check("bias, root", axis, truth.bias_spread[axis], 20.0);
        for (octave, low) in [10, 20, 40, 80].into_iter().enumerate() {
            check(&format!("vibration from {low} Hz"), axis, truth.vibration[axis][octave], 1.0);
        }
    }
    assert!(numbers == 21 && inside >= 18, "{inside} of {numbers}");
}

/// Situation: an accelerometer that repeats one sample in ten and a steer angle 4 ms after the gyro, late by up to 2
/// ms in 99 of 100 and 6 ms at worst.
/// Action: fit models.
/// Must hold: fraction, phase and lateness are the simulated ones; the reasons of the others are reported.
#[test]
fn repeats_and_lateness_are_estimated() {
    let fitted = FittedErrors { repeat: 0.1, white: [0.03; 3], ..FittedErrors::default() };
    let accel = SensorModel { every_ticks: 10, fitted, ..SensorModel::default() };
    let fitted = FittedErrors {
        phase_ticks: 4,
        jitter_ticks: [2, 6],
        quantum: [2e-3, 0.0, 0.0],
        ..FittedErrors::default()
    };
    let steer = SensorModel { every_ticks: 10, fitted, ..SensorModel::default() };
    let white = FittedErrors { white: [1e-3; 3], ..FittedErrors::default() };
    let gyro = SensorModel { every_ticks: 10, fitted: white, ..SensorModel::default() };
    let all = recordings(&[(Sensor::Gyro, gyro), (Sensor::Accel, accel), (Sensor::Steer, steer)], 1);
    let accel = fit(Sensor::Accel, &all).expect("a model");
    let m = number(&accel, "share of samples that repeat, riding", "");
    assert!((m.low..=m.high).contains(&0.1) && m.high - m.low < 0.03, "{m:?}");
    let steer = fit(Sensor::Steer, &all).expect("a model");
    let [most, worst] = steer.jitter_s.expect("jitter");
    assert!((most - 0.002).abs() < 3e-4 && (0.0045..0.0065).contains(&worst), "{most} {worst}");
    let phase = steer.phase_s.expect("a phase");
    assert!((0.004..0.0065).contains(&phase), "{phase}");
    assert_eq!(steer.quantum, [0.002]);
    for (found, error) in
        [(&steer, "lag: the yaw rate leads"), (&steer, "vibration: "), (&accel, "bias and walk: ")]
    {
        assert!(found.left_out.iter().any(|what| what.starts_with(error)), "{:?}", found.left_out);
    }
    assert!(fit(Sensor::RiderTorque, &all).expect_err("none").to_string().contains("rider-torque"));
}

/// Situation: two minutes of an accelerometer at 100 Hz, stamped up to 0.2 ms late; none, six single samples, or six
/// pairs in a row are lost.
/// Action: fit a model.
/// Must hold: the lateness is the jitter's, whichever samples are lost.
#[test]
fn lost_samples_are_not_late() {
    let lost = |each: u64| {
        let stays = |n: &u64| n % 2000 >= each || *n == 0;
        let late = |n: u64| 2e-4 * ((n * 7919) % 1000) as f64 / 1000.0;
        let sample = |n| Sample { t_s: n as f64 * 0.01 + late(n), value: [late(n), 0.0, 9.81] };
        let track = |sensor| Track {
            sensor,
            samples: (0..12_000).filter(|n| stays(&(n + 1500))).map(sample).collect(),
            made_up: [false; 3],
        };
        let tracks = [Sensor::Accel, Sensor::RearWheel].map(track).into();
        let samples = Samples { tracks, ..Samples::default() };
        let all = [Recording { samples, distance_m: Vec::new() }];
        fit(Sensor::Accel, &all).expect("a model").jitter_s.expect("jitter")
    };
    for each in [0, 1, 2] {
        let [most, worst] = lost(each);
        assert!((1.8e-4..2.1e-4).contains(&most), "{each} lost: {most}");
        assert!((1.9e-4..2.2e-4).contains(&worst), "{each} lost: {worst}");
    }
}
