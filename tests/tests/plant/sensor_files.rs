//! Files of sensor models.

use proptest::prelude::*;
use proptest::sample::select;
use sim_host::plant::sensor_file::{SHIPPED, SensorFile};
use sim_host::plant::{Plant, Sensor, SensorConfig, SensorModel};
use tests::draws::runner;

const HEAD: &str = "source = \"s\"\nlicence = \"l\"\ncommand = \"c\"\n";

/// Situation: the shipped files.
/// Action: read and apply each, in control periods of 1 and 2 ms.
/// Must hold: each has a sensor, its source, licence and command; no other sensor changes; the plant can be
/// simulated.
#[test]
fn shipped_models_can_be_simulated() {
    assert!(SHIPPED.len() >= 7);
    for (name, _) in SHIPPED {
        let file = SensorFile::load(name).expect(name);
        assert!([&file.source, &file.licence, &file.command].iter().all(|text| text.len() > 10), "{name}");
        for period_s in [1e-3, 2e-3] {
            let mut plant = Plant::default();
            file.apply(&mut plant.sensors, period_s).expect(name);
            plant.check().expect(name);
            assert!(!plant.mirrors() || name == "hall-16" || file.gyro.is_none(), "{name}");
            for sensor in Sensor::ALL {
                let departs = *plant.sensors.model(sensor) != SensorModel::default();
                assert_eq!(departs, file.of(sensor).is_some(), "{name} {}", sensor.name());
            }
        }
    }
}

/// Situation: a gyro at 200 Hz with a density of 2e-4 rad/s/Hz^0.5, 4 ms late.
/// Must hold: a deviation of 2e-3 rad/s on each sample, as the band ends at 100 Hz; times in control periods of
/// either length.
#[test]
fn densities_and_times_become_those_of_samples() {
    let text = format!("{HEAD}[gyro]\nperiod_s = 0.005\ndelay_s = 0.0042\nwhite_density = [2e-4, 0, 0]\n");
    let file = SensorFile::parse(&text).expect("sound");
    for (period_s, every, delay) in [(1e-3, 5, 4), (2.5e-3, 2, 2)] {
        let mut sensors = SensorConfig::default();
        file.apply(&mut sensors, period_s).expect("applies");
        let model = sensors.model(Sensor::Gyro);
        assert_eq!((model.every_ticks, model.delay_ticks), (every, delay));
        assert!((model.fitted.white[0] - 2e-3).abs() < 1e-12 && model.fitted.white[1] == 0.0);
    }
}

/// Situation: a valid file with one error in it.
/// Must hold: rejected, table, key, value and allowed values named.
#[test]
fn errors_in_a_file_are_named() {
    for (table, says) in [
        ("[gyros]\n", &["gyros", "gyro"][..]),
        ("[gyro]\nnoise = 1\n", &["noise", "white_density"]),
        ("[gyro]\nperiod_s = \"5ms\"\n", &["period_s", "5ms"]),
        ("[gyro]\nperiod_s = 0\n", &["gyro: period_s = 0", "0.0001 to 1"]),
        ("[gyro]\nwhite_density = [1, 1, 1]\n", &["gyro: white_density", "no period_s"]),
        ("[gyro]\nperiod_s = 0.01\nwhite_density = [1]\n", &["white_density has 1 values, the sensor 3"]),
        (
            "[steer]\nvibration = [[1, 1, 1, 1], [1, 1, 1, 1]]\n",
            &["steer: vibration has 2 values, the sensor 1"],
        ),
        ("[accel]\nwalk = [0, -1, 0]\n", &["accel: walk = -1", "0 to 1000"]),
        ("[accel]\nrepeat = 1\n", &["accel: repeat = 1", "0 to 0.999"]),
        ("[accel]\nquantum = [nan, 0, 0]\n", &["accel: quantum = NaN"]),
        ("[accel]\njitter_s = [0.02, 0.01]\n", &["accel: accel jitter", "below"]),
        ("[steer]\nperiod_s = 0.01\nphase_s = 0.01\n", &["phase (control periods) = 10", "0 to 9"]),
        ("[steer]\npulses_per_turn = 16\n", &["only wheels"]),
        ("[wheel]\nwindow_s = 11\n", &["wheel: window_s = 11", "0 to 10"]),
        ("[wheel]\nmeasured = [{ number = \"x\" }]\n", &["measured", "unit"]),
    ] {
        let error = SensorFile::parse(&format!("{HEAD}{table}")).expect_err(table);
        assert!(says.iter().all(|word| error.to_string().contains(word)), "{table}: {error}");
    }
    let error = SensorFile::parse("[gyro]\n").expect_err("no source");
    assert!(error.to_string().contains("source"), "{error}");
    assert!(SensorFile::load("no-such").expect_err("none").to_string().contains("mpu6050-robot"));
}

/// Situation: tables of any keys with any values. Must hold: a model that can be simulated, or a reason; never a panic.
#[test]
fn a_file_is_valid_or_rejected() {
    const KEYS: &[&str] = &[
        "period_s",
        "phase_s",
        "jitter_s",
        "delay_s",
        "window_s",
        "pulses_per_turn",
        "quantum",
        "repeat",
        "white_density",
        "walk",
        "bias_spread",
        "vibration",
        "measured",
        "left_out",
        "x",
    ];
    const VALUES: &[&str] = &[
        "0",
        "1",
        "-1",
        "0.01",
        "0.005",
        "1e99",
        "nan",
        "inf",
        "\"a\"",
        "[0.1]",
        "[0.1, 0.2]",
        "[1, 2, 3]",
        "[]",
        "[[0, 1, 2, 3]]",
        "[[0, 1, 2, 3], [0, 0, 0, 0], [1, 1, 1, 1e9]]",
        "70000",
        "true",
        "{}",
    ];
    const TABLES: &[&str] =
        &["gyro", "accel", "steer", "steer-rate", "wheel", "rider-torque", "motor-report"];
    let pairs = proptest::collection::hash_map(select(KEYS), select(VALUES), 0..5);
    runner(2000)
        .run(&(select(TABLES), pairs), |(table, pairs)| {
            let lines: String = pairs.iter().map(|(key, value)| format!("{key} = {value}\n")).collect();
            let text = format!("{HEAD}[{table}]\n{lines}");
            match SensorFile::parse(&text) {
                Ok(file) => {
                    let mut plant = Plant::default();
                    prop_assert_eq!(file.apply(&mut plant.sensors, 1e-3), Ok(()), "{}", text);
                    prop_assert!(plant.check().is_ok(), "{}", text);
                }
                Err(why) => prop_assert!(!why.to_string().is_empty()),
            }
            Ok(())
        })
        .unwrap();
}
