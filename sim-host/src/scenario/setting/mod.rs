//! The settings of a scenario by name, as text: options of the command line and axes of a sweep read this table.

use super::search::Speeds;
use super::{Content, Scenario, speeds, text};
use crate::parameters::Value;
use crate::plant::FaultTextError;
use crate::range::time;
use crate::ride::Start;
use crate::rider::MAX_DELAY_S;

/// A setting: how it is named and described, and how its text changes a scenario.
#[derive(Debug)]
pub struct Setting {
    /// Name: `--name` on the command line, key of an axis.
    pub name: &'static str,
    /// Key in a scenario's file, with dots.
    pub key: &'static str,
    /// Placeholder of the value in help texts.
    pub value: &'static str,
    /// Description.
    pub help: &'static str,
    /// Default as text; `None` if it depends on other settings.
    pub default: Option<&'static str>,
    /// The allowed words and their meaning; empty if the value is not a word of a list.
    pub words: &'static [(&'static str, &'static str)],
    /// Whether it must be given where it is an option.
    pub required: bool,
    /// Whether it may be given several times.
    pub repeats: bool,
    /// Whether a value may begin with a hyphen.
    pub hyphen: bool,
    /// Whether a wrong value is bad input, not wrong usage: values with a grammar of their own.
    pub grammar: bool,
    /// Changes a scenario; an error states the text and what is expected.
    pub set: fn(&mut Scenario, &str) -> Result<(), String>,
}

/// A setting with the most usual properties.
const PLAIN: Setting = Setting {
    name: "",
    key: "",
    value: "",
    help: "",
    default: None,
    words: &[],
    required: false,
    repeats: false,
    hyphen: true,
    grammar: false,
    set: |_, _| Ok(()),
};

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
        value: "NM/S|none",
        help: "Largest change of torque in N m/s, or none [default: none; product: 100]",
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
        value: "TIME",
        help: "Delay of the simulated sensors, for example 20ms; a whole number of control periods",
        default: Some("0ms"),
        set: |s, text| {
            s.sensor_delay_s = time(text, 3600.0).map_err(|e| e.to_string())?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "sensor",
        key: "plant.sensors",
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
        value: "CHANNEL:KIND@FROM..TO",
        help: "Inject a fault, for example gyro.x:stuck@1.5s..2s or motor:dead@1s, or none; may be repeated",
        repeats: true,
        grammar: true,
        set: |s, text| {
            match text {
                super::content::NONE => s.plant.faults.clear(),
                _ => s.plant.faults.push(text.parse().map_err(|e: FaultTextError| e.to_string())?),
            }
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "seed",
        key: "plant.seed",
        value: "N",
        help: "Seed of noise and dropouts; each ride derives its own from its initial state",
        default: Some("0"),
        hyphen: false,
        set: |s, text| {
            // TOML has no larger whole numbers.
            let seed = text::whole(text).ok().filter(|seed| *seed <= i64::MAX as u64);
            s.plant.seed =
                seed.ok_or_else(|| format!("`{text}` is not a whole number from 0 to {}", i64::MAX))?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "parameters",
        key: "parameter_file",
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

/// The rider alone.
pub const RIDERS: &[Setting] = &[RIDER, GAINS, DELAY, GAINS_OUTSIDE];

const RIDER: Setting = Setting {
    name: "rider",
    key: "rider.table",
    value: "NAME|FILE",
    help: "Rider: a built-in one (see `rider list`), a table FILE, or none [default: none, a rigid rider, hands off]",
    hyphen: false,
    set: |s, text| {
        s.rider.table = Some(text.into());
        Ok(())
    },
    ..PLAIN
};

const GAINS: Setting = Setting {
    name: "gains",
    key: "rider.gains",
    value: "GAINS",
    help: "Fit of the rider's gains over speed [default: mean]",
    words: &[
        (
            "regression",
            "One straight line per gain (LR in the thesis): the table's own `regression`, otherwise least squares over all sets",
        ),
        ("mean", "Straight lines through the groups' means, at the mean of their speeds (LI, mean)"),
        ("best", "Straight lines through each group's best set, at that set's speed (LI, HV)"),
    ],
    hyphen: false,
    set: |s, text| {
        s.rider.gains = Some(text::word(text)?);
        Ok(())
    },
    ..PLAIN
};

const DELAY: Setting = Setting {
    name: "delay",
    key: "rider.delay_s",
    value: "TIME",
    help: "The rider's neural delay, 0 to 1 s, for example 60ms [default: the table's own]",
    set: |s, text| {
        s.rider.delay_s = Some(time(text, MAX_DELAY_S).map_err(|e| e.to_string())?);
        Ok(())
    },
    ..PLAIN
};

const GAINS_OUTSIDE: Setting = Setting {
    name: "gains-outside",
    key: "rider.outside",
    value: "GAINS_OUTSIDE",
    help: "The rider's gains beyond the measured speeds [default: extrapolate]",
    words: &[
        ("extrapolate", "The outermost straight lines are extrapolated, as published"),
        ("hold", "The outermost gains are held"),
    ],
    hyphen: false,
    set: |s, text| {
        s.rider.outside = Some(text::word(text)?);
        Ok(())
    },
    ..PLAIN
};

/// The fall criterion.
pub const FALL: Setting = Setting {
    name: "fall",
    key: "fall",
    value: "KEY=VALUE,...|published",
    help: "Fall: roll or steer passes these angles, or the bicycle lies flat short of them for a time after the flat angle of roll; published has no flat",
    default: Some("roll=90deg,steer=90deg,flat=80deg,lasting=1s"),
    set: |s, text| {
        s.fall = text::fall(text)?.into();
        Ok(())
    },
    ..PLAIN
};

/// The search of a basin.
pub const SEARCH: &[Setting] = &[
    Setting {
        name: "speeds",
        key: "search.speeds",
        value: "A:B:STEP",
        help: "Forward speeds in m/s: A:B:STEP, B included, or one [default: 0:10:0.1; 2:7.5:0.1 with a rider]",
        set: |s, text| {
            speeds::parse(text)?;
            s.search.speeds = Some(Speeds::Range(text.into()));
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "axis",
        key: "search.axis",
        value: "AXIS",
        help: "The rate that is disturbed at t = 0",
        default: Some("steer-rate"),
        words: &[("steer-rate", "The steer rate"), ("roll-rate", "The roll rate")],
        hyphen: false,
        set: |s, text| {
            s.search.axis = text::word(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "max-rate",
        key: "search.max_rate",
        value: "RAD/S",
        help: "Largest disturbance tried, in rad/s",
        default: Some("30"),
        set: |s, text| {
            s.search.max_rate = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "scan-step",
        key: "search.scan_step",
        value: "RAD/S",
        help: "Step of the scan, in rad/s; narrower islands or gaps can be missed",
        default: Some("0.25"),
        set: |s, text| {
            s.search.scan_step = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "tolerance",
        key: "search.tolerance",
        value: "RAD/S",
        help: "Accuracy of the borders, in rad/s",
        default: Some("0.01"),
        set: |s, text| {
            s.search.tolerance = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
];

/// The number of drawn bicycles.
pub const UNCERTAIN: Setting = Setting {
    name: "uncertain",
    key: "uncertain",
    value: "N",
    help: "Also compute the basins of N bicycles drawn from the uncertainties of the bicycle's parameters, 2 to 10000, as a band from the 5 % to the 95 % quantile of their heights; --seed changes the draws",
    set: |s, text| {
        let count = text::whole(text).ok().filter(|count| DRAWS.contains(count));
        let wrong = || format!("{text} is not in {}..={}", DRAWS.start(), DRAWS.end());
        s.uncertain = Some(count.ok_or_else(wrong)?);
        Ok(())
    },
    ..PLAIN
};

/// Allowed numbers of drawn bicycles.
pub(super) const DRAWS: std::ops::RangeInclusive<u32> = 2..=10_000;

/// The disturbance of one ride.
pub const START: &[Setting] = &[
    Setting {
        name: "speed",
        key: "start.speed_m_s",
        value: "M/S",
        help: "Forward speed at the start, in m/s; below 0 only with --law none: backwards, as with a steered rear wheel",
        required: true,
        set: |s, text| {
            start(s).speed_m_s = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "steer-rate",
        key: "start.steer_rate_rad_s",
        value: "RAD/S",
        help: "Steer rate at the start, in rad/s, right positive",
        default: Some("0"),
        set: |s, text| {
            start(s).steer_rate_rad_s = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "roll-rate",
        key: "start.roll_rate_rad_s",
        value: "RAD/S",
        help: "Roll rate at the start, in rad/s, right positive",
        default: Some("0"),
        set: |s, text| {
            start(s).roll_rate_rad_s = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
];

/// The initial state; its speed is unknown (NaN) until it is set.
fn start(scenario: &mut Scenario) -> &mut Start {
    scenario.start.get_or_insert(Start { speed_m_s: f64::NAN, ..Start::default() })
}

/// The search of a plane.
pub const PLANE: &[Setting] = &[
    Setting {
        name: "speed",
        key: "plane.speed",
        value: "M/S",
        help: "Forward speed, in m/s",
        required: true,
        set: |s, text| {
            s.plane.get_or_insert_default().speed = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "rays",
        key: "plane.rays",
        value: "N",
        help: "Number of directions over half a turn, 2 to 10000; the other half is the mirror image",
        default: Some("60"),
        hyphen: false,
        set: |s, text| {
            s.plane.get_or_insert_default().rays = text::whole(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "max-steer-rate",
        key: "plane.max_steer_rate",
        value: "RAD/S",
        help: "Largest steer rate tried, in rad/s",
        default: Some("20"),
        set: |s, text| {
            s.plane.get_or_insert_default().max_steer_rate = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "max-roll-rate",
        key: "plane.max_roll_rate",
        value: "RAD/S",
        help: "Largest roll rate tried, in rad/s",
        default: Some("4"),
        set: |s, text| {
            s.plane.get_or_insert_default().max_roll_rate = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "points",
        key: "plane.points",
        value: "N",
        help: "Rides of the scan along each ray; an island or gap narrower than their distance can be missed",
        default: Some("80"),
        hyphen: false,
        set: |s, text| {
            s.plane.get_or_insert_default().points = text::whole(text)?;
            Ok(())
        },
        ..PLAIN
    },
    Setting {
        name: "ray-tolerance",
        key: "plane.tolerance",
        value: "PART",
        help: "Accuracy of borders, as a fraction of a ray",
        default: Some("0.0005"),
        set: |s, text| {
            s.plane.get_or_insert_default().tolerance = text::number(text)?;
            Ok(())
        },
        ..PLAIN
    },
];

/// The setting with this key in a scenario's file.
pub fn of_key(key: &str) -> Option<&'static Setting> {
    [CONDITIONS, SEARCH, START, PLANE, &[UNCERTAIN]].into_iter().flatten().find(|setting| setting.key == key)
}
