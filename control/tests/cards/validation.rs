//! Validation of the declared sensors, each with its own causes.

use control::sensors::measurements::Measurements;
use control::sensors::validation::{self, ValidationPlan, ValidationState};
use control::{
    Calibration, Cause, Causes, Config, Loss, Sample, Sensor, SensorFrame, State, Triple, ValidationConfig,
    Wheel,
};

const PERIOD_S: f32 = 1e-3;

/// A step at 1 kHz with the default calibration.
pub(crate) fn step(
    config: &ValidationConfig,
    state: &mut ValidationState,
    frame: &SensorFrame,
    torque_nm: f32,
) -> Measurements {
    let plan = ValidationPlan::new(config, PERIOD_S);
    validation::step(config, &plan, &Calibration::default().plan(), state, frame, torque_nm)
}

/// A sensor: its declaration, its sample in a frame, its measurement, and its four causes.
struct Case {
    name: &'static str,
    declared: fn(&mut ValidationConfig) -> &mut Sensor,
    set: fn(&mut SensorFrame, f32, u16),
    measured: fn(&Measurements) -> Option<f32>,
    codes: [Cause; 4],
}

fn triple(value: f32, age_ticks: u16) -> Triple {
    Triple { value: [0.0, 0.0, value], age_ticks }
}

fn cases() -> [Case; 9] {
    use Cause::*;
    [
        Case {
            name: "gyro",
            declared: |c| &mut c.gyro,
            set: |f, value, age| f.gyro_rad_s = triple(value, age),
            measured: |b| b.gyro_rad_s().map(|v| v[2]),
            codes: [GyroLost, GyroRange, GyroJump, GyroStuck],
        },
        Case {
            name: "accel",
            declared: |c| &mut c.accel,
            set: |f, value, age| f.accel_m_s2 = triple(value, age),
            measured: |b| b.accel_m_s2().map(|v| v[2]),
            codes: [AccelLost, AccelRange, AccelJump, AccelStuck],
        },
        Case {
            name: "steer",
            declared: |c| &mut c.steer,
            set: |f, value, age_ticks| f.steer_rad = Sample { value, age_ticks },
            measured: |b| b.steer_rad(),
            codes: [SteerLost, SteerRange, SteerJump, SteerStuck],
        },
        Case {
            name: "steer rate",
            declared: |c| &mut c.steer_rate,
            set: |f, value, age_ticks| f.steer_rate_rad_s = Sample { value, age_ticks },
            measured: |b| b.steer_rate_rad_s(),
            codes: [SteerRateLost, SteerRateRange, SteerRateJump, SteerRateStuck],
        },
        Case {
            name: "front wheel",
            declared: |c| &mut c.front_wheel,
            set: |f, value, age_ticks| f.front_wheel_m_s = Sample { value, age_ticks },
            measured: |b| b.front_wheel_m_s().map(|v| v.newest),
            codes: [FrontWheelLost, FrontWheelRange, FrontWheelJump, FrontWheelStuck],
        },
        Case {
            name: "rear wheel",
            declared: |c| &mut c.rear_wheel,
            set: |f, value, age_ticks| f.rear_wheel_m_s = Sample { value, age_ticks },
            measured: |b| b.rear_wheel_m_s().map(|v| v.newest),
            codes: [RearWheelLost, RearWheelRange, RearWheelJump, RearWheelStuck],
        },
        Case {
            name: "rider's torque",
            declared: |c| &mut c.rider_torque,
            set: |f, value, age_ticks| f.rider_torque_nm = Sample { value, age_ticks },
            measured: |b| b.rider_torque_nm(),
            codes: [RiderTorqueLost, RiderTorqueRange, RiderTorqueJump, RiderTorqueStuck],
        },
        Case {
            name: "motor",
            declared: |c| &mut c.motor,
            set: |f, value, age_ticks| f.motor_torque_nm = Sample { value, age_ticks },
            measured: |b| b.motor_torque_nm(),
            codes: [MotorLost, MotorRange, MotorJump, MotorStuck],
        },
        Case {
            name: "path",
            declared: |c| &mut c.path,
            set: |f, value, age_ticks| {
                (f.heading_error_rad, f.lateral_error_m) = (Sample::fresh(0.0), Sample { value, age_ticks });
            },
            measured: |b| b.path().map(|[_, lateral]| lateral),
            codes: [PathLost; 4],
        },
    ]
}

/// No sensor is fitted.
pub(crate) fn bare() -> ValidationConfig {
    ValidationConfig {
        gyro: Sensor::default(),
        front_wheel: Sensor::default(),
        ..ValidationConfig::default()
    }
}

/// Only this sensor: range 100, step 1, lost after 2 periods, stuck after 5 of motion.
fn alone(case: &Case) -> ValidationConfig {
    let mut config = bare();
    *(case.declared)(&mut config) = Sensor {
        step: 1.0,
        slope_per_s: Some(1.0),
        timeout_ticks: 2,
        stuck_ticks: 5,
        ..Sensor::exact(100.0)
    };
    config
}

/// Situation: one sensor fitted and valid.
/// Action: good samples, then one that is late, out of range or a jump.
/// Must hold: only that sensor has a measurement; only its own cause is reported.
#[test]
fn each_sensor_has_its_measurement_and_causes() {
    for case in cases() {
        let config = alone(&case);
        let [lost, range, jump, _] = case.codes;
        for (value, age, cause) in [(2.5, 1, lost), (f32::NAN, 0, range), (100.5, 0, range), (50.0, 0, jump)]
        {
            let mut state = ValidationState::default();
            let mut at = |value, age| {
                let mut frame = SensorFrame::missing();
                (case.set)(&mut frame, value, age);
                step(&config, &mut state, &frame, 0.0)
            };
            for value in [2.0, 2.5] {
                let b = at(value, 0);
                assert_eq!((case.measured)(&b), Some(value), "{}", case.name);
                let others = cases().iter().filter(|other| (other.measured)(&b).is_some()).count();
                assert_eq!((others, b.causes), (1, Causes::NONE), "{}", case.name);
            }
            let checked: Vec<Measurements> = (0..3).map(|k| at(value, age + k)).collect();
            assert_eq!((case.measured)(&checked[1]), Some(2.5), "{}: held", case.name);
            assert_eq!((case.measured)(&checked[2]), None, "{}: {cause:?}", case.name);
            assert_eq!(checked[2].causes, Causes::of(cause), "{}", case.name);
        }
    }
}

/// Motion shown by the other sensors, above and below the threshold.
type Motion = (&'static str, fn(&mut SensorFrame, f32) -> f32);

/// Situation: a sensor repeats one sample.
/// Action: each other sensor moves, by slightly less and slightly more than the threshold.
/// Must hold: stuck after its time if the sensor must follow that motion, else never.
#[test]
fn stuck_is_found_by_motion_of_other_sensors() {
    // Each changes the frame of period k and returns the torque commanded before it. A trembling signal changes by
    // exactly the threshold.
    let motions: [Motion; 14] = [
        ("nothing", |_, _| 0.0),
        ("steer turns", |f, k| {
            f.steer_rad.value = -1.01e-3 * k;
            0.0
        }),
        ("steer creeps", |f, k| {
            f.steer_rad.value = 0.99e-3 * k;
            0.0
        }),
        ("steer trembles", |f, k| {
            f.steer_rad.value = 1e-3 * (k % 2.0);
            0.0
        }),
        ("steer rate", |f, _| {
            f.steer_rate_rad_s.value = -1.01;
            0.0
        }),
        ("small steer rate", |f, _| {
            f.steer_rate_rad_s.value = 1.0;
            0.0
        }),
        ("frame rolls", |f, _| {
            f.gyro_rad_s.value[0] = -0.51;
            0.0
        }),
        ("frame rolls slowly", |f, _| {
            f.gyro_rad_s.value[0] = 0.5;
            0.0
        }),
        ("front wheel", |f, k| {
            f.front_wheel_m_s.value = 4.0 + 1e-6 * k;
            0.0
        }),
        ("rear wheel", |f, k| {
            f.rear_wheel_m_s.value = 4.0 - 1e-6 * k;
            0.0
        }),
        ("torque", |_, k| -0.0101 * k),
        ("small torque", |_, k| 0.0099 * k),
        ("trembling torque", |_, k| 0.01 * (k % 2.0)),
        ("not a number", |f, _| {
            (f.steer_rad.value, f.steer_rate_rad_s.value) = (f32::NAN, f32::NAN);
            f32::NAN
        }),
    ];
    for case in cases() {
        let config = alone(&case);
        let followed: &[&str] = match case.name {
            "gyro" | "rider's torque" => &["steer turns", "steer rate"],
            "accel" => &["frame rolls"],
            "steer" => &["steer rate"],
            "steer rate" => &["steer turns"],
            "front wheel" => &["rear wheel"],
            "rear wheel" => &["front wheel"],
            "motor" => &["torque"],
            _ => &[],
        };
        for (name, motion) in motions {
            let mut state = ValidationState::default();
            let checked: Vec<Causes> = (0_u8..60)
                .map(|k| {
                    let mut frame = SensorFrame::missing();
                    (frame.front_wheel_m_s.value, frame.rear_wheel_m_s.value) = (4.0, 4.0);
                    // From 1 on: a small difference of large numbers would be inexact.
                    let torque = motion(&mut frame, 1.0 + f32::from(k));
                    (case.set)(&mut frame, 0.25, 0);
                    step(&config, &mut state, &frame, torque).causes
                })
                .collect();
            let stuck = checked.iter().any(|causes| causes.has(case.codes[3]));
            assert_eq!(stuck, followed.contains(&name), "{} while {name}: {checked:?}", case.name);
            assert!(checked[..4].iter().all(|causes| causes.is_empty()), "{} while {name}", case.name);
        }
    }
}

/// Situation: the path's two errors, one of them old.
/// Action: step.
/// Must hold: the path's age is that of the older error, in both cases.
#[test]
fn the_path_is_as_old_as_its_older_error() {
    let config = ValidationConfig { path: Sensor { timeout_ticks: 2, ..Sensor::exact(10.0) }, ..bare() };
    for late in [0, 1] {
        let mut state = ValidationState::default();
        let mut at = |age| {
            let mut ages = [0; 2];
            ages[late] = age;
            let [heading_error_rad, lateral_error_m] = ages.map(|age_ticks| Sample { value: 0.5, age_ticks });
            let frame = SensorFrame { heading_error_rad, lateral_error_m, ..SensorFrame::missing() };
            step(&config, &mut state, &frame, 0.0)
        };
        for age in 0..=2 {
            assert_eq!(at(age).path(), Some([0.5; 2]), "{late} {age}");
        }
        let checked = at(3);
        assert_eq!((checked.path(), checked.causes), (None, Causes::of(Cause::PathLost)), "{late}");
    }
}

/// Situation: sensors fitted on one wheel, on the other, on both.
/// Action: schedule by either wheel.
/// Must hold: scheduled by that wheel; a single sensor is moved to it.
#[test]
fn a_single_wheel_sensor_moves_to_the_scheduling_wheel() {
    let fitted = |front: bool, rear: bool| {
        let sensor = |fitted, max| Sensor { fitted, ..Sensor::exact(max) };
        ValidationConfig { front_wheel: sensor(front, 11.0), rear_wheel: sensor(rear, 22.0), ..bare() }
    };
    for (front, rear, moves) in
        [(true, false, true), (false, true, true), (true, true, false), (false, false, false)]
    {
        let before = fitted(front, rear);
        assert_eq!(before.scheduled_by(Wheel::Front), before, "as it was");
        let after = before.scheduled_by(Wheel::Rear);
        assert_eq!(after.wheel, Wheel::Rear);
        let expected = if moves { (22.0, 11.0) } else { (11.0, 22.0) };
        assert_eq!((after.front_wheel.max, after.rear_wheel.max), expected);
        assert_eq!(after.scheduled_by(Wheel::Front), before, "and back");
    }
}

/// Situation: declared sensors.
/// Action: read the causes of each loss, and the slowest qualification.
/// Must hold: the causes of the sensors declared so, no others; only fitted sensors count.
#[test]
fn declarations_are_summarised() {
    for case in cases() {
        let mut config = bare();
        *(case.declared)(&mut config) = Sensor { loss: Loss::Limp, qualify_samples: 7, ..Sensor::exact(1.0) };
        assert_eq!(config.causes_of(Loss::Limp), Causes::all(&case.codes), "{}", case.name);
        assert_eq!(config.causes_of(Loss::Fault), Causes::NONE, "{}", case.name);
        assert_eq!(config.slowest_to_qualify(), 7, "{}", case.name);
        (case.declared)(&mut config).fitted = false;
        assert_eq!(config.slowest_to_qualify(), 0, "{}", case.name);
    }
    assert_eq!(Config::product().input.slowest_to_qualify(), 50);
}

/// Situation: the front wheel schedules; front wheel, steer angle and rear wheel are fitted or not.
/// Action: make a plan.
/// Must hold: rejected, naming key and remedy, if the front wheel's speed would have to come from the rear wheel alone;
/// else accepted, as is every case scheduled by the rear wheel.
#[test]
fn the_scheduling_speed_must_be_measurable() {
    for (front, steer, rear) in [false, true]
        .into_iter()
        .flat_map(|a| [(a, false, false), (a, false, true), (a, true, false), (a, true, true)])
    {
        let mut config = Config::product();
        let input = &mut config.input;
        (input.front_wheel.fitted, input.steer.fitted, input.rear_wheel.fitted) = (front, steer, rear);
        let by_rear =
            Config { input: ValidationConfig { wheel: Wheel::Rear, ..config.input }, ..config.clone() };
        assert!(by_rear.plan().is_ok());
        match config.plan() {
            Ok(_) => assert!(front || steer || !rear),
            Err(error) => {
                assert!(!front && !steer && rear, "{error}");
                let error = error.to_string();
                assert!(error.contains("input.wheel = front") && error.ends_with(": rear"), "{error}");
            }
        }
    }
}

/// Situation: call rates from 100 to 10000 Hz, some with periods that are no whole number of microseconds, one whose
/// period in milliseconds is rounded down.
/// Action: set `input.max_gap_ms` to a microsecond less than the longest period, and to that period; step at the rate.
/// Must hold: the former is rejected with key, value and range; with the latter no period is a fault of timing; as
/// flashed the lowest rate is rejected.
#[test]
fn a_permitted_gap_is_no_shorter_than_the_control_period() {
    let rejected = |rate_hz: f32, ms: f32| {
        let mut config = Config { rate_hz, ..Config::product() };
        config.input.max_gap_ms = Some(ms);
        config.plan().map_err(|error| error.to_string())
    };
    for (rate_hz, longest_us) in [
        (100.0_f32, 10_000_u32),
        (300.0, 3334),
        (1000.0, 1000),
        (1e6 / 502.0, 502),
        (7000.0, 143),
        (10_000.0, 100),
    ] {
        let [shorter_ms, ms] = [longest_us - 1, longest_us].map(|us| us as f32 / 1e3);
        let error = rejected(rate_hz, shorter_ms).expect_err("shorter than a period");
        let least = if longest_us > 100 { ms } else { 0.1 };
        assert_eq!(
            error,
            format!("input.max_gap_ms = {shorter_ms} is outside {least} to 1000"),
            "{rate_hz} Hz"
        );
        let plan = rejected(rate_hz, ms).expect("as long as a period");
        let mut state = State::default();
        for i in 0..1000_u32 {
            let now_us = (1e6 * f64::from(i) / f64::from(rate_hz)) as u32;
            let command = control::step(&plan, &mut state, &SensorFrame { now_us, ..SensorFrame::missing() });
            assert!(!command.causes.has(Cause::Timing), "{rate_hz} Hz, {now_us} us");
        }
    }
    let flashed = Config { rate_hz: 100.0, ..Config::product() }.plan().expect_err("10 ms");
    assert_eq!(flashed.to_string(), "input.max_gap_ms = 5 is outside 10 to 1000");
}
