//! Each part of a sensor model compared with its closed form.

use nalgebra::{Rotation3, Vector3};
use sim_host::plant::{ImuMount, Plant, Reading, Sensor, SensorModel, SensorSuite};
use sim_host::ride::Start;

const START: Start = Start { speed_m_s: 4.0, steer_rate_rad_s: 5.0, roll_rate_rad_s: 0.0 };

/// Measured value and age of the steer angle, whose true value at tick t is `truth(t)`.
fn measured(model: SensorModel, ticks: i64, truth: impl Fn(f64) -> f64) -> Vec<(f64, u16)> {
    let mut plant = Plant::default();
    *plant.sensors.model_mut(Sensor::Steer) = model;
    plant.check().expect("in range");
    let steady = Reading::steady(4.0, 9.81);
    let mut sensors = SensorSuite::new(&plant, 1e-3, &START, &steady);
    (0..ticks)
        .map(|tick| {
            let now = Reading { steer_rad: truth(tick as f64), ..steady };
            let held = *sensors.measure(&plant, &now, true).of(Sensor::Steer);
            (held.value[0], held.age_ticks)
        })
        .collect()
}

/// Situation: delays of 0 to 20 control periods, a sample every 1 to 7.
/// Action: a true value that counts.
/// Must hold: at every tick the newest sample that can have arrived, and its age since then; before the first one the
/// steady ride's.
#[test]
fn delay_and_sampling_are_exact() {
    for delay in [0, 1, 5, 20] {
        for every in [1, 2, 7] {
            let model = SensorModel { delay_ticks: delay, every_ticks: every, ..SensorModel::default() };
            for (tick, (value, age)) in measured(model, 60, |t| t + 1.0).into_iter().enumerate() {
                let arrived = tick as i64 - i64::from(delay);
                let sampled = arrived - arrived.rem_euclid(i64::from(every));
                let expected = if sampled >= 0 { sampled as f64 + 1.0 } else { 0.0 };
                assert_eq!(
                    (value, i64::from(age)),
                    (expected, arrived - sampled),
                    "{delay} {every} at {tick}"
                );
            }
        }
    }
}

/// Situation: a scale of 1.1 and a bias of 0.02; steps of 0.01; a range of 0.5.
/// Action: a sweep in both directions.
/// Must hold: `1.1 x + 0.02` before the range cuts it; within half a step of it and on a whole step; odd without
/// bias.
#[test]
fn scale_bias_range_and_quantum() {
    let sweep = |t: f64| (t - 100.0) * 0.00931;
    let skewed = SensorModel { scale: 1.1, bias: [0.02, 0.0, 0.0], ..SensorModel::default() };
    let coarse = SensorModel { quantum: 0.01, ..SensorModel::default() };
    let narrow = SensorModel { range: Some(0.5), ..skewed };
    let [skewed, coarse, narrow] = [skewed, coarse, narrow].map(|model| measured(model, 201, sweep));
    let mut furthest = 0.0_f64;
    for t in 0..201 {
        let x = sweep(t as f64);
        assert_eq!(skewed[t].0, x * 1.1 + 0.02);
        assert_eq!(narrow[t].0, (x * 1.1 + 0.02).clamp(-0.5, 0.5));
        assert!(((coarse[t].0 / 0.01).round() * 0.01 - coarse[t].0).abs() < 1e-15);
        furthest = furthest.max((coarse[t].0 - x).abs());
        assert_eq!(coarse[t].0, -coarse[200 - t].0);
    }
    assert!((0.0045..=0.005 + 1e-15).contains(&furthest), "{furthest}");
}

/// Situation: noise of 0.05 rad, and one sample in ten lost.
/// Action: 20,000 ticks.
/// Must hold: mean, deviation and neighbours' correlation within five standard errors; the lost fraction too, and a
/// lost sample leaves the previous one in place.
#[test]
fn noise_and_dropout_have_their_statistics() {
    let n = 20_000;
    let noisy = measured(SensorModel { noise: 0.05, ..SensorModel::default() }, n, |_| 1.0);
    let errors: Vec<f64> = noisy.iter().map(|(value, _)| value - 1.0).collect();
    let samples = n as f64;
    let mean = errors.iter().sum::<f64>() / samples;
    let deviation = (errors.iter().map(|e| e * e).sum::<f64>() / samples).sqrt();
    let neighbours = errors.windows(2).map(|e| e[0] * e[1]).sum::<f64>() / samples;
    assert!(mean.abs() < 5.0 * 0.05 / samples.sqrt(), "{mean}");
    assert!((deviation - 0.05).abs() < 5.0 * 0.05 / (2.0 * samples).sqrt(), "{deviation}");
    assert!(neighbours.abs() < 5.0 * 0.0025 / samples.sqrt(), "{neighbours}");
    let lossy = measured(SensorModel { dropout: 0.1, ..SensorModel::default() }, n, |t| t);
    let lost = lossy.iter().filter(|(_, age)| *age > 0).count() as f64 / samples;
    assert!((lost - 0.1).abs() < 5.0 * (0.09 / samples).sqrt(), "{lost}");
    for (tick, (value, age)) in lossy.into_iter().enumerate().skip(50) {
        assert_eq!(value, tick as f64 - f64::from(age));
    }
}

/// Situation: an IMU turned by up to 0.4 rad about all three axes. Action: read gyro and accelerometer.
/// Must hold: the rotation about z, then y, then x, by another implementation.
#[test]
fn a_turned_imu_measures_the_turned_vector() {
    let turned_rad = [0.1, -0.2, 0.4];
    let mut plant = Plant::default();
    plant.sensors.imu = ImuMount { turned_rad, ..ImuMount::default() };
    let truth = Reading { gyro_rad_s: [0.7, -1.1, 2.3], ..Reading::steady(4.0, 9.81) };
    let mut sensors = SensorSuite::new(&plant, 1e-3, &START, &truth);
    let measured = sensors.measure(&plant, &truth, true);
    let [x, y, z] = turned_rad;
    let sensor_in_frame = Rotation3::from_euler_angles(x, y, z);
    for sensor in [Sensor::Gyro, Sensor::Accel] {
        let expected = sensor_in_frame.inverse() * Vector3::from(truth.of(sensor));
        assert!((expected - Vector3::from(measured.of(sensor).value)).amax() < 1e-14);
    }
}

/// Situation: the default model, and any true value.
/// Must hold: the true value, to the bit, with no age.
#[test]
fn the_default_sensor_is_exact() {
    let odd = [0.0, -0.0, 1.0, f64::MIN_POSITIVE, -3.7e300, f64::INFINITY];
    for (sample, x) in measured(SensorModel::default(), 6, |t| odd[t as usize]).into_iter().zip(odd) {
        assert_eq!((sample.0.to_bits(), sample.1), (x.to_bits(), 0));
    }
}

/// Situation: models with one value outside its range.
/// Must hold: rejected, sensor and value named.
#[test]
fn a_model_out_of_range_is_rejected() {
    let ok = SensorModel::default();
    for (model, says) in [
        (SensorModel { every_ticks: 0, ..ok }, "steer every"),
        (SensorModel { scale: f64::NAN, ..ok }, "steer scale"),
        (SensorModel { noise: -1.0, ..ok }, "steer noise"),
        (SensorModel { range: Some(0.0), ..ok }, "steer range"),
        (SensorModel { quantum: -0.1, ..ok }, "steer quantum"),
        (SensorModel { dropout: 1.1, ..ok }, "steer dropout"),
        (SensorModel { delay_ticks: 5001, ..ok }, "steer delay"),
        (SensorModel { bias: [0.0, f64::INFINITY, 0.0], ..ok }, "steer bias"),
    ] {
        let mut plant = Plant::default();
        *plant.sensors.model_mut(Sensor::Steer) = model;
        let message = plant.check().expect_err(says).to_string();
        assert!(message.contains(says), "{message}");
    }
}
