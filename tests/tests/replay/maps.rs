//! Meaning of the columns by a map.

use super::{PROGRAM, SMALLEST, sampled, track};
use sim_host::plant::Sensor;
use sim_host::recording::CAN_LOGS;
use sim_host::replay::{Map, SHIPPED};
use std::f64::consts::PI;
use tests::cli::Bench;

/// Within rounding errors of this number of digits.
fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * a.abs().max(1.0)
}

/// Situation: columns in degrees, g, km/h and milliseconds.
/// Action: declare them in the map.
/// Must hold: the samples are in rad, rad/s, m/s^2, m/s and s.
#[test]
fn units() {
    let text = "t,gx,gy,gz,ax,ay,az,steer,rear\n0,90,0,-180,0,0.5,-1,45,36\n5,90,0,-180,0,0.5,-1,45,36\n";
    let map = "[time]\ncolumn = 't'\nunit = 'ms'\n\
        [gyro]\ncolumns = ['gx', 'gy', 'gz']\nunit = 'deg/s'\n[accel]\ncolumns = ['ax', 'ay', 'az']\nunit = 'g'\n\
        [steer]\ncolumns = ['steer']\nunit = 'deg'\n[rear_wheel]\ncolumns = ['rear']\nunit = 'km/h'\n";
    let last = |sensor| *track(text, map, sensor).last().unwrap();
    assert!(near(last(Sensor::Gyro).t_s, 0.005));
    for (sensor, expected) in [
        (Sensor::Gyro, [0.5 * PI, 0.0, -PI]),
        (Sensor::Accel, [0.0, 0.5 * 9.80665, -9.80665]),
        (Sensor::Steer, [0.25 * PI, 0.0, 0.0]),
        (Sensor::RearWheel, [10.0, 0.0, 0.0]),
    ] {
        let value = last(sensor).value;
        assert!(value.iter().zip(expected).all(|(a, b)| near(*a, b)), "{}: {value:?}", sensor.name());
    }
}

/// Situation: an IMU whose y points forward, whose x points left, and whose z points down.
/// Action: rotate it by `axes`.
/// Must hold: x forward, y right, z down.
#[test]
fn axes_are_turned() {
    let text = "t,gx,gy,gz,rear\n0,1,2,3,4\n1,1,2,3,4\n";
    let map = SMALLEST.replace("'gz']", "'gz']\naxes = ['y', '-x', 'z']");
    assert_eq!(track(text, &map, Sensor::Gyro)[0].value, [2.0, -1.0, 3.0]);
}

/// Situation: a steer sensor in degrees that counts to the left, twice as far, and reads 8 straight ahead.
/// Action: scale, then offset, both in its unit.
/// Must hold: radians to the right.
#[test]
fn sign_scale_and_offset() {
    let text = "t,gx,gy,gz,rear,s\n0,0,0,0,4,8\n1,0,0,0,4,-172\n";
    let map = format!("{SMALLEST}[steer]\ncolumns = ['s']\nunit = 'deg'\nscale = -0.5\noffset = 4\n");
    let steer = track(text, &map, Sensor::Steer);
    assert!(near(steer[0].value[0], 0.0) && near(steer[1].value[0], 0.5 * PI), "{steer:?}");
}

/// Situation: a log with the roll rate alone.
/// Action: constants for the other axes; or leave them to the program.
/// Must hold: the constants, in the unit of the map; gravity for an accelerometer's z; reported as substituted.
#[test]
fn constants_and_substitutes() {
    let text = "t,gx,ay,rear\n0,1,0.1,4\n1,1,0.1,4\n";
    let map = "[time]\ncolumn = 't'\n[gyro]\ncolumns = ['gx', 0, 180]\nunit = 'deg/s'\n\
        [accel]\ncolumns = ['ax', 'ay', 'az']\n[rear_wheel]\ncolumns = ['rear']\n";
    let samples = sampled(text, map).unwrap();
    let gyro = samples.track(Sensor::Gyro).unwrap();
    assert!(near(gyro.samples[0].value[2], PI) && gyro.made_up == [false, true, true], "{gyro:?}");
    let accel = samples.track(Sensor::Accel).unwrap();
    let [x, y, z] = accel.samples[0].value;
    assert!(x == 0.0 && near(y, 0.1) && near(z, -9.81), "{accel:?}");
    assert_eq!(accel.made_up, [true, false, true]);
}

/// Situation: an IMU in g, mounted upside down, with its sideways axis alone in the log.
/// Action: rotate it by `axes`.
/// Must hold: gravity has the direction that it has for every other bicycle.
#[test]
fn substitutes_of_a_rotated_sensor() {
    let text = "t,gx,gy,gz,ay,rear\n0,0,0,0,0.5,4\n1,0,0,0,0.5,4\n";
    let map = format!(
        "{SMALLEST}[accel]\ncolumns = ['ax', 'ay', 'az']\nunit = 'g'\noffset = 0.1\naxes = ['x', '-y', '-z']\n"
    );
    let value = track(text, &map, Sensor::Accel)[0].value;
    assert!(near(value[0], 0.0) && near(value[1], -0.6 * 9.80665) && near(value[2], -9.81), "{value:?}");
}

/// Situation: a wheel that has a value in every second row only.
/// Action: read it.
/// Must hold: as many samples as values, at their own times: a blank is no sample, not a zero.
#[test]
fn blanks_are_no_samples() {
    let text = "t,gx,gy,gz,rear\n0,1,1,1,4\n1,1,1,1,\n2,1,1,1,5\n3,1,1,1,NaN\n4,1,1,1,6\n";
    let rear = track(text, SMALLEST, Sensor::RearWheel);
    let pairs: Vec<_> = rear.iter().map(|sample| (sample.t_s, sample.value[0])).collect();
    assert_eq!(pairs, [(0.0, 4.0), (2.0, 5.0), (4.0, 6.0)]);
    assert_eq!(track(text, SMALLEST, Sensor::Gyro).len(), 5);
}

/// Situation: a wheel with times of its own; one with a column of its age; one that comes 20 ms late.
/// Action: name the column of the time, of the age, or the lateness.
/// Must hold: its samples are at these times; a sample that only grew older is not new.
#[test]
fn own_times_ages_and_lateness() {
    let text = "t,gx,gy,gz,rear,t_rear,age\n1,0,0,0,4,0.9,0\n1.001,0,0,0,4,0.95,1\n1.002,0,0,0,4,0.99,2\n1.003,0,0,0,5,1.1,0\n";
    let times = |more: &str| -> Vec<f64> {
        let map = format!("{SMALLEST}{more}\n");
        track(text, &map, Sensor::RearWheel).iter().map(|sample| sample.t_s).collect()
    };
    assert_eq!(times(""), [1.0, 1.001, 1.002, 1.003]);
    assert_eq!(times("time = 't_rear'"), [0.9, 0.95, 0.99, 1.1]);
    assert_eq!(times("age = 'age'"), [1.0, 1.003]);
    let late = times("late_s = 0.02");
    assert!(late.iter().zip([1.02, 1.021, 1.022, 1.023]).all(|(a, b)| near(*a, b)), "{late:?}");
}

/// Situation: a log without a column of time; one whose times are dates.
/// Action: give the rows per second; name the column.
/// Must hold: rows at that distance; seconds.
#[test]
fn rates_and_dates() {
    let text = "gx,gy,gz,rear\n1,1,1,4\n1,1,1,4\n1,1,1,4\n";
    let rated = SMALLEST.replace("column = 't'", "rate_hz = 50");
    let times = |text: &str, map: &str| -> Vec<f64> {
        track(text, map, Sensor::Gyro).iter().map(|sample| sample.t_s).collect()
    };
    assert_eq!(times(text, &rated), [0.0, 0.02, 0.04]);
    let dated = "t,gx,gy,gz,rear\n2026-05-01 12:00:00.25,1,1,1,4\n2026-05-01T12:00:01.5Z,1,1,1,4\n";
    let at = times(dated, SMALLEST);
    assert!((at[1] - at[0] - 1.25).abs() < 1e-6 && at[0] > 1.7e9, "{at:?}");
}

/// Situation: the shipped maps.
/// Action: load each by its name.
/// Must hold: they are valid, have at least gyro and a wheel, and name no column twice.
#[test]
fn shipped_maps_are_right() {
    for (name, _) in SHIPPED {
        let map = Map::load(name).unwrap_or_else(|error| panic!("{error}"));
        let sensors: Vec<Sensor> = map.sensors().map(|mapped| mapped.sensor).collect();
        assert!(sensors.contains(&Sensor::Gyro) && sensors.contains(&Sensor::RearWheel), "{name}");
        let mut columns: Vec<String> = map
            .sensors()
            .flat_map(|mapped| &mapped.signal.columns)
            .map(|source| format!("{source:?}"))
            .collect();
        let all = columns.len();
        columns.sort();
        columns.dedup();
        assert_eq!(columns.len(), all, "{name}");
    }
}

/// Situation: the shipped maps and the formats of CAN logs.
/// Action: the help of `replay`.
/// Must hold: it lists each.
#[test]
fn the_help_lists_every_map_and_log() {
    let help = Bench::new(PROGRAM).run("replay --help").stdout;
    let words: Vec<&str> = help.split_whitespace().collect();
    let listed = |names: &[&str]| words.join(" ").contains(&names.join(", "));
    assert!(listed(&SHIPPED.map(|(name, _)| name)) && listed(&CAN_LOGS), "{help}");
}
