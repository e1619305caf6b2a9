//! Settings of bicycle, law, limits, plant and fall.

use super::rider::{DELAY, GAINS, GAINS_OUTSIDE, RIDER};
use super::{PLAIN, Setting};
use crate::parameters::Value;
use crate::range::time;
use crate::scenario::content::{Content, NONE};
use crate::scenario::text;

/// Bicycle, rider, law, limits, plant and fall: what a ride needs besides its disturbance.
pub const CONDITIONS: &[Setting] = &[
    BICYCLE,
    BICYCLE_SET,
    RIDER,
    GAINS,
    DELAY,
    GAINS_OUTSIDE,
    Setting {
        name: "law",
        key: "law",
        long_name: "roll-rate law",
        value: "LAW",
        help: "Roll-rate law: none, h, h-cut, f, g, cl1, cl2:K, balance-assist:K, or a table FILE [default: h; none with a rider; product: h-cut]",
        hyphen: false,
        set: |s, text| {
            s.law = Some(text.into());
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "preset",
        key: "preset",
        long_name: "defaults",
        value: "PRESET",
        help: "Defaults of the options below",
        default: Some("thesis"),
        words: &[
            ("thesis", "The published conditions: law h, every limit off"),
            ("product", "The flashed configuration: law h-cut, limits, sensor checks, engagement"),
        ],
        hyphen: false,
        set: |s, text| {
            s.preset = text::word(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "assist",
        key: "assist",
        long_name: "what computes the torque",
        value: "ASSIST",
        help: "What computes the torque",
        default: Some("firmware"),
        words: &[
            ("firmware", "The firmware's control crate: f32, sampled, with all limits"),
            ("ideal", "The law alone in f64, continuous, without limits"),
        ],
        hyphen: false,
        set: |s, text| {
            s.assist = text::word(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "schedule-speed",
        key: "schedule_speed",
        long_name: "speed that schedules the gain",
        value: "SCHEDULE_SPEED",
        help: "Speed that schedules the gain",
        default: Some("front"),
        words: &[
            ("front", "Front wheel rate times its radius; reproduces the published basins"),
            ("rear", "Rear wheel rate times its radius"),
            ("initial", "The speed at t = 0, constant"),
        ],
        hyphen: false,
        set: |s, text| {
            s.schedule_speed = text::word(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "torque-limit",
        key: "torque_limit_nm",
        long_name: "largest torque of the assist",
        value: "NM|none",
        help: "Largest torque in N m, or none [default: none; product: 7]",
        set: |s, text| {
            s.torque_limit_nm = Some(text::limit(text)?);
            s.parameters.remove("limits.max_torque_nm");
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "rate-limit",
        key: "rate_limit_nm_s",
        long_name: "largest change of torque of the assist",
        value: "NM/S|none",
        help: "Largest change of torque in N m/s, or none [default: none; product: 100 rising, 200 falling]",
        set: |s, text| {
            s.rate_limit_nm_s = Some(text::limit(text)?);
            s.parameters.remove("limits.rise_nm_s");
            s.parameters.remove("limits.fall_nm_s");
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "taper",
        key: "taper_m_s",
        long_name: "speeds between which the torque rises from zero",
        value: "ZERO:FULL|none",
        help: "Taper: torque zero at the first, full at the second speed in m/s, or none [default: none; product: 0.5:1.5]",
        set: |s, text| {
            s.taper_m_s = Some(text::taper(text)?);
            s.parameters.retain(|key, _| !key.starts_with("limits.taper"));
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "sensor-delay",
        key: "sensor_delay_s",
        long_name: "delay of the sensors",
        value: "TIME",
        help: "Delay of the simulated sensors, for example 20ms; a whole number of control periods",
        default: Some("0ms"),
        set: |s, text| {
            s.sensor_delay_s = time(text, 3600.0)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "sensor",
        key: "plant.sensors",
        long_name: "errors of the sensors",
        value: "MODEL|NAME:KEY=VALUE,...",
        help: "Sensor errors: models of real sensors by name or FILE, several joined by +; or NAME:KEY=VALUE,... for example gyro:noise=0.01,bias=0.02,delay=5ms or front-wheel:model=hall-16; or none; may be repeated",
        repeats: true,
        grammar: true,
        set: |s, text| text::sensor(&mut s.plant, text),
        ..PLAIN
    },
    Setting {
        name: "actuator",
        key: "plant.actuator",
        long_name: "motor, steer friction and end stop",
        value: "NAME|FILE|KEY=VALUE,...",
        help: "Motor, steer friction and end stop: none, davis, gazelle, a FILE, and KEY=VALUE to change values",
        default: Some("none"),
        grammar: true,
        set: |s, text| {
            s.plant.actuator = text::actuator(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "fault",
        key: "plant.faults",
        long_name: "injected faults",
        value: "CHANNEL:KIND@FROM..TO",
        help: "Inject a fault, for example gyro.x:stuck@1.5s..2s or motor:dead@1s, or none; may be repeated. \
               CHANNEL: gyro, accel, steer, steer-rate, front-wheel, rear-wheel, rider-torque, motor-report, path (KIND: stuck, \
               missing, late=TIME, noise=X, bias=X, drift=X/s, scale=X, flip, jump=X, spike=X, nan, value=X, dropout=P, slow=TIME), \
               motor (dead, stuck, late=TIME, noise=X, bias=X, drift=X/s, scale=X, flip, value=X, slow=TIME), engage (stuck, flip, \
               value=X, missing), clock (stuck, scale=X, jump=X)",
        repeats: true,
        grammar: true,
        set: |s, text| {
            match text {
                NONE => s.plant.faults.clear(),
                _ => s.plant.faults.push(text.parse()?),
            }
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "seed",
        key: "plant.seed",
        long_name: "seed of noise and dropouts",
        value: "N",
        help: "Seed of noise and dropouts; each ride derives its own from its initial state",
        default: Some("0"),
        set: |s, text| {
            s.plant.seed = text::seed(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "parameters",
        key: "parameter_file",
        long_name: "file of the firmware's parameters",
        value: "FILE",
        help: "Law and parameters of the firmware from a file, as written by `param export`; other options have precedence",
        hyphen: false,
        set: |s, text| {
            s.parameter_file = Some(Content::Named(text.into()));
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "set",
        key: "parameters",
        long_name: "parameters of the firmware",
        value: "KEY=VALUE",
        help: "Any parameter of the firmware, for example limits.rise_nm_s=50 or limits.end_stop=on; may be repeated",
        repeats: true,
        hyphen: false,
        grammar: true,
        set: |s, text| {
            let (key, value) = text::pair(text)?;
            s.parameters.insert(key.into(), Value::from(value));
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "imu",
        key: "imu",
        long_name: "roll rate that the gyro measures",
        value: "IMU",
        help: "Roll rate that the gyro measures: derivative of the roll angle, or angular rate about the frame's axis",
        default: Some("euler"),
        words: &[
            ("euler", "The exact rate of the roll angle (the published laws' signal)"),
            ("body", "The rear frame's angular velocity about its own x axis, as measured by a gyro on it"),
        ],
        hyphen: false,
        set: |s, text| {
            s.imu = text::word(text)?;
            Ok(())
        },
        ..PLAIN
    },
    FALL,
    Setting {
        name: "time-limit",
        key: "time_limit_s",
        long_name: "duration of a ride that does not fall",
        value: "S",
        help: "Duration of a ride that does not fall, in seconds",
        default: Some("6"),
        set: |s, text| {
            s.time_limit_s = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "recovered-below",
        key: "recovered_below",
        long_name: "fraction of the maxima below which a ride has recovered",
        value: "FRACTION",
        help: "A ride has recovered if roll and steer end below this fraction of their maxima",
        default: Some("0.1"),
        set: |s, text| {
            s.recovered_below = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
];

/// The bicycle alone.
pub const BICYCLES: &[Setting] = &[BICYCLE, BICYCLE_SET];

const BICYCLE: Setting = Setting {
    name: "bicycle",
    key: "bicycle",
    value: "NAME|FILE",
    help: "Built-in bicycle (see `bicycle list`), FILE, or FILE#NAME of a collection",
    default: Some("rigid_jason"),
    hyphen: false,
    set: |s, text| {
        s.bicycle = text.into();
        Ok(())
    },
    ..PLAIN
};

const BICYCLE_SET: Setting = Setting {
    name: "bicycle-set",
    key: "bicycle_set",
    long_name: "changed parameters of the bicycle",
    value: "KEY=VALUE",
    help: "Changes one of the bicycle's parameters, SI units, for example lam=0.3; may be repeated",
    repeats: true,
    hyphen: false,
    grammar: true,
    set: |s, text| {
        let (key, value) = text::pair(text)?;
        s.bicycle_set.insert(key.into(), text::number(value)?);
        Ok(())
    },
    ..PLAIN
};

/// The fall criterion.
pub const FALL: Setting = Setting {
    name: "fall",
    key: "fall",
    long_name: "criterion of a fall",
    value: "KEY=VALUE,...|published",
    help: "Fall: roll or steer passes these angles, or the bicycle lies flat short of them for a time after the flat angle of roll; published has no flat",
    default: Some("roll=90deg,steer=90deg,flat=80deg,lasting=1s"),
    set: |s, text| {
        s.fall = text::fall(text)?.into();
        Ok(())
    },
    ..PLAIN
};
