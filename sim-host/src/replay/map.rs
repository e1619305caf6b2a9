//! A map assigns the columns of a recording to sensors, with unit, sign and axes. `docs/replay.md`.

use super::map_error::{ColumnsError, MapError, MapTextError, SignalError};
use super::unit::Quantity;
use crate::plant::Sensor;
use crate::recording::Recording;
use std::fmt::{self, Display};
use std::path::Path;

/// The built-in maps, by name.
pub const SHIPPED: [(&str, &str); 5] = [
    ("can-bicycle", include_str!("../../../data/maps/can-bicycle.toml")),
    ("extract", include_str!("../../../data/maps/extract.toml")),
    ("monitor", include_str!("../../../data/maps/monitor.toml")),
    ("robot-bicycle", include_str!("../../../data/maps/robot-bicycle.toml")),
    ("sbw-bicycle", include_str!("../../../data/maps/sbw-bicycle.toml")),
];

/// Columns that only the table of `ride --csv` has together.
const RIDE_COLUMNS: [&str; 3] = ["rear_wheel_rate", "measured_roll_rate", "rider_torque"];

/// Assignment of a recording's columns.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Map {
    /// How samples are converted to the control periods between them.
    #[serde(default)]
    pub resample: Resample,
    /// Source of a row's time; not needed for a recording with its own times.
    pub time: Option<Time>,
    gyro: Option<Signal>,
    accel: Option<Signal>,
    steer: Option<Signal>,
    steer_rate: Option<Signal>,
    front_wheel: Option<Signal>,
    rear_wheel: Option<Signal>,
    rider_torque: Option<Signal>,
    motor: Option<Signal>,
    path: Option<Signal>,
    /// The rider's switch: on where the column is not 0. Without this key the switch is pressed whenever a press would
    /// engage.
    pub engage: Option<Switch>,
    /// The recording's own motion signals, for comparison.
    #[serde(default)]
    pub reference: References,
    /// Disturbances of a perturbation record, for `identify`.
    #[serde(default)]
    pub perturbation: Perturbation,
    /// Parameters of the firmware for this bicycle, with values as in `--set`.
    #[serde(default)]
    pub parameters: toml::Table,
}

/// How samples are converted to the control periods between them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "lowercase")]
pub enum Resample {
    /// Each sample is held, with growing age, until the next one: what a board would have received.
    #[default]
    Hold,
    /// Linear interpolation between two samples: what a faster sensor would have measured, except for its noise.
    Interpolate,
}

/// Source of a row's time: a column, or the row's number.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// Column with the time.
    pub column: Option<String>,
    /// Its unit: s, ms, us or ns. A date with a time of day needs no unit.
    pub unit: Option<String>,
    /// Rows per second, if there is no column.
    pub rate_hz: Option<f64>,
}

/// The rider's switch.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Switch {
    /// Its column.
    pub column: String,
}

/// The recording's own signals.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct References {
    /// Roll angle.
    pub roll: Option<Signal>,
    /// Steer torque of the recorded bicycle's own assist.
    pub torque: Option<Signal>,
    /// Distance counted by a wheel sensor.
    pub distance: Option<Signal>,
}

/// The disturbances of a perturbation record, and its roll rate where there is no gyro.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Perturbation {
    /// Lateral force on the rear frame, to the right positive.
    pub lateral_force: Option<Signal>,
    /// Steer torque beside the rider's, to the right positive.
    pub steer_torque: Option<Signal>,
    /// Roll rate.
    pub roll_rate: Option<Signal>,
}

/// A column, or a constant in place of a missing one.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(untagged)]
pub enum Source {
    /// A column by its name; on a bus also `Message.Signal`.
    Column(String),
    /// Always this value, in the signal's unit.
    Constant(f64),
}

/// One sensor in a recording.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Signal {
    /// Its columns: one for each axis.
    pub columns: Vec<Source>,
    /// Their unit; SI if absent.
    pub unit: Option<String>,
    /// Factor of every axis, before the offset.
    #[serde(default = "one")]
    pub scale: f64,
    /// Added to every axis, in `unit`.
    #[serde(default)]
    pub offset: f64,
    /// For three axes: which of the sensor's axes, with its sign, points along the bicycle's x (forward), y (right) and
    /// z (down).
    pub axes: Option<[String; 3]>,
    /// Column with the time of these samples, in the unit of `time`, if it differs from the row's.
    pub time: Option<String>,
    /// Column with the age of the sample at the row's time \[control periods\].
    pub age: Option<String>,
    /// Delay from the time of a sample to its reception by the controller \[s\].
    #[serde(default)]
    pub late_s: f64,
}

impl Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Column(name) => write!(f, "`{name}`"),
            Self::Constant(value) => write!(f, "the constant {value}"),
        }
    }
}

const fn one() -> f64 {
    1.0
}

/// A sensor with its checked columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Mapped<'a> {
    /// Which sensor.
    pub sensor: Sensor,
    /// Source of its samples.
    pub signal: &'a Signal,
}

impl Map {
    /// The built-in map of this name, or the map in a file.
    ///
    /// # Errors
    /// The file with key, value and expected values.
    pub fn load(name: &str) -> Result<Self, MapError> {
        let content = |error| MapError::Content { name: name.into(), error: Box::new(error) };
        if let Some((_, text)) = SHIPPED.iter().find(|(shipped, _)| *shipped == name) {
            return Self::parse(text).map_err(content);
        }
        let known = || SHIPPED.map(|(name, _)| name).join(", ");
        let read = |error| MapError::Read { name: name.into(), error, known: known() };
        Self::parse(&crate::input_file::text(Path::new(name)).map_err(read)?).map_err(content)
    }

    /// Parses a map.
    ///
    /// # Errors
    /// The key with its value and the expected values.
    pub fn parse(text: &str) -> Result<Self, MapTextError> {
        let map: Self =
            toml::from_str(text).map_err(|e| MapTextError::Syntax(e.to_string().trim().into()))?;
        map.check()?;
        Ok(map)
    }

    /// The built-in map whose gyro and time columns the recording has.
    ///
    /// # Errors
    /// There is none.
    pub fn by_columns(recording: &Recording) -> Result<Self, ColumnsError> {
        let has = |name: &str| {
            recording.groups.iter().flat_map(|group| &group.columns).any(|column| column.name == name)
        };
        let fits = |map: &Self| {
            let gyro = map.gyro.iter().flat_map(|gyro| &gyro.columns);
            let time = map.time.as_ref().and_then(|time| time.column.as_deref());
            time.is_none_or(has)
                && gyro.into_iter().all(|source| matches!(source, Source::Column(name) if has(name)))
        };
        let known = SHIPPED.iter().filter_map(|(_, text)| Self::parse(text).ok()).find(fits);
        let ride = RIDE_COLUMNS.into_iter().all(has);
        known.ok_or(if ride { ColumnsError::Ride } else { ColumnsError::Unknown })
    }

    /// The signal of one sensor.
    pub(super) fn of(&self, sensor: Sensor) -> Option<&Signal> {
        self.sensors().find(|mapped| mapped.sensor == sensor).map(|mapped| mapped.signal)
    }

    /// The sensors that the map assigns, in the order of [`Sensor::ALL`].
    pub fn sensors(&self) -> impl Iterator<Item = Mapped<'_>> {
        let of = |sensor| match sensor {
            Sensor::Gyro => &self.gyro,
            Sensor::Accel => &self.accel,
            Sensor::Steer => &self.steer,
            Sensor::SteerRate => &self.steer_rate,
            Sensor::FrontWheel => &self.front_wheel,
            Sensor::RearWheel => &self.rear_wheel,
            Sensor::RiderTorque => &self.rider_torque,
            Sensor::MotorReport => &self.motor,
            Sensor::Path => &self.path,
        };
        let mapped = move |sensor| of(sensor).as_ref().map(|signal| Mapped { sensor, signal });
        Sensor::ALL.into_iter().filter_map(mapped)
    }

    fn check(&self) -> Result<(), MapTextError> {
        if let Some(time) = &self.time {
            Quantity::Time.factor(time.unit.as_deref()).map_err(MapTextError::TimeUnit)?;
            match (&time.column, time.rate_hz) {
                (Some(_), None) => {}
                (None, Some(rate_hz)) if (0.01..=1e5).contains(&rate_hz) => {}
                (None, Some(rate_hz)) => {
                    return Err(MapTextError::Rate(rate_hz));
                }
                _ => return Err(MapTextError::Time),
            }
        }
        for Mapped { sensor, signal } in self.sensors() {
            let checked = signal.check(axes_of(sensor), quantity_of(sensor));
            checked.map_err(|error| MapTextError::Signal { key: sensor.key().into(), error })?;
        }
        let References { roll, torque, distance } = &self.reference;
        let Perturbation { lateral_force, steer_torque, roll_rate } = &self.perturbation;
        for (key, signal, quantity) in [
            ("reference.roll", roll, Quantity::Angle),
            ("reference.torque", torque, Quantity::Torque),
            ("reference.distance", distance, Quantity::Length),
            ("perturbation.lateral_force", lateral_force, Quantity::Force),
            ("perturbation.steer_torque", steer_torque, Quantity::Torque),
            ("perturbation.roll_rate", roll_rate, Quantity::Rate),
        ] {
            let checked = signal.as_ref().map_or(Ok(()), |signal| signal.check(1, quantity));
            checked.map_err(|error| MapTextError::Signal { key: key.into(), error })?;
        }
        Ok(())
    }
}

/// Number of columns of a sensor.
pub(super) fn axes_of(sensor: Sensor) -> usize {
    sensor.axes().len().max(1)
}

/// Quantity that a sensor measures; the path has an angle (heading) and a length (lateral deviation).
pub(super) const fn quantity_of(sensor: Sensor) -> Quantity {
    match sensor {
        Sensor::Gyro | Sensor::SteerRate => Quantity::Rate,
        Sensor::Accel => Quantity::SpecificForce,
        Sensor::Steer | Sensor::Path => Quantity::Angle,
        Sensor::FrontWheel | Sensor::RearWheel => Quantity::Speed,
        Sensor::RiderTorque | Sensor::MotorReport => Quantity::Torque,
    }
}

impl Signal {
    fn check(&self, axes: usize, quantity: Quantity) -> Result<(), SignalError> {
        if self.columns.len() != axes {
            return Err(SignalError::Columns { given: self.columns.len(), expected: axes });
        }
        quantity.factor(self.unit.as_deref())?;
        let in_range = |key: &'static str, value: f64, most: f64| match value.abs() <= most {
            true => Ok(()),
            false => Err(SignalError::Range { key, value, most }),
        };
        in_range("scale", self.scale, 1e6)?;
        if self.scale == 0.0 {
            return Err(SignalError::Scale);
        }
        in_range("offset", self.offset, 1e6)?;
        if !(0.0..=1.0).contains(&self.late_s) {
            return Err(SignalError::Late(self.late_s));
        }
        match (&self.axes, axes) {
            (Some(axes), 3) => turned(axes).map(drop),
            (Some(_), _) => Err(SignalError::NoAxes),
            (None, _) => Ok(()),
        }
    }

    /// For each of the bicycle's axes, the sensor's own axis and sign.
    pub(super) fn turns(&self) -> [(usize, f64); 3] {
        let straight = [(0, 1.0), (1, 1.0), (2, 1.0)];
        self.axes.as_ref().and_then(|axes| turned(axes).ok()).unwrap_or(straight)
    }
}

/// Indices and signs of `["-y", "x", "z"]`.
fn turned(axes: &[String; 3]) -> Result<[(usize, f64); 3], SignalError> {
    let one = |word: &String| {
        let (sign, letter) = word.strip_prefix('-').map_or((1.0, word.as_str()), |letter| (-1.0, letter));
        let place = ["x", "y", "z"].iter().position(|axis| *axis == letter);
        place.map(|place| (place, sign)).ok_or_else(|| SignalError::Axis(word.clone()))
    };
    let [x, y, z] = axes;
    let turns = [one(x)?, one(y)?, one(z)?];
    // Each axis once, and right-handed: a mirrored sensor is an error in the map.
    let [a, b, c] = turns;
    let even = [(0, 1, 2), (1, 2, 0), (2, 0, 1)].contains(&(a.0, b.0, c.0));
    let odd = [(0, 2, 1), (2, 1, 0), (1, 0, 2)].contains(&(a.0, b.0, c.0));
    let signs = a.1 * b.1 * c.1;
    match (even, odd) {
        (false, false) => Err(SignalError::Twice(axes.clone())),
        (true, _) if signs > 0.0 => Ok(turns),
        (_, true) if signs < 0.0 => Ok(turns),
        _ => Err(SignalError::LeftHanded(axes.clone())),
    }
}
