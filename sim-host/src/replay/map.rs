//! A map says what the columns of a recording mean: which sensor, unit, sign and axes. `docs/replay.md`.

use super::unit::Quantity;
use crate::plant::Sensor;
use crate::recording::Recording;
use std::fmt::{self, Display};
use std::path::Path;

/// The maps that ship, by name.
pub const SHIPPED: [(&str, &str); 4] = [
    ("can-bicycle", include_str!("../../../data/maps/can-bicycle.toml")),
    ("extract", include_str!("../../../data/maps/extract.toml")),
    ("monitor", include_str!("../../../data/maps/monitor.toml")),
    ("robot-bicycle", include_str!("../../../data/maps/robot-bicycle.toml")),
];

/// What the columns mean.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Map {
    /// How samples reach the control periods between them.
    #[serde(default)]
    pub resample: Resample,
    /// Where a row's time stands; a recording that brings its own times needs none.
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
    /// The rider's switch: on where the column is not 0. Without it the switch is pressed whenever that would engage.
    pub engage: Option<Switch>,
    /// What the log itself says of the motion, to compare with.
    #[serde(default)]
    pub reference: References,
    /// Parameters of the flashed code that this bicycle needs, in the words of `--set`.
    #[serde(default)]
    pub parameters: toml::Table,
}

/// How samples reach the control periods between them.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize, clap::ValueEnum,
)]
#[serde(rename_all = "lowercase")]
pub enum Resample {
    /// Each is held, growing older, until the next one comes: what a board would have got.
    #[default]
    Hold,
    /// On a straight line between two samples: what a faster sensor would have said, but for its noise.
    Interpolate,
}

/// Where the time of a row stands: in a column, or it follows from the number of rows.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Time {
    /// Column with the time.
    pub column: Option<String>,
    /// Its unit: s, ms, us or ns. A date with a time of day is understood as it is.
    pub unit: Option<String>,
    /// Rows a second, where there is no column.
    pub rate_hz: Option<f64>,
}

/// The rider's switch.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Switch {
    /// Its column.
    pub column: String,
}

/// What the log itself says.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct References {
    /// Roll angle.
    pub roll: Option<Signal>,
    /// Steer torque of the log's own assist.
    pub torque: Option<Signal>,
}

/// A column, or a number that stands for one that is not there.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(untagged)]
pub enum Source {
    /// A column by its name; of a bus also `Message.Signal`.
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
    /// Their unit; SI without it.
    pub unit: Option<String>,
    /// Factor of every axis, before the offset.
    #[serde(default = "one")]
    pub scale: f64,
    /// Added to every axis, in the unit.
    #[serde(default)]
    pub offset: f64,
    /// Of three axes: which of the log's, with its sign, points along the bicycle's x (forward), y (right) and z (down).
    pub axes: Option<[String; 3]>,
    /// Column with the time of these samples, in the unit of `time`, where it is not the row's.
    pub time: Option<String>,
    /// Column with the age of the sample at the row's time \[control periods\].
    pub age: Option<String>,
    /// How much later than their time the samples reached the controller \[s\].
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

/// A map with what it was checked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Mapped<'a> {
    /// Which sensor.
    pub sensor: Sensor,
    /// Where its samples stand.
    pub signal: &'a Signal,
}

impl Map {
    /// The map of a name, or in a file.
    ///
    /// # Errors
    /// The file with the key, value and what was expected.
    pub fn load(name: &str) -> Result<Self, String> {
        if let Some((_, text)) = SHIPPED.iter().find(|(shipped, _)| *shipped == name) {
            return Self::parse(text).map_err(|why| format!("{name}: {why}"));
        }
        let path = Path::new(name);
        let text = std::fs::read_to_string(path).map_err(|why| {
            let names: Vec<_> = SHIPPED.iter().map(|(shipped, _)| *shipped).collect();
            format!("can't read the map {name}: {why}; those that ship are {}", names.join(", "))
        })?;
        Self::parse(&text).map_err(|why| format!("{name}: {why}"))
    }

    /// The map in a text.
    ///
    /// # Errors
    /// The key, its value and what was expected.
    pub fn parse(text: &str) -> Result<Self, String> {
        let map: Self = toml::from_str(text).map_err(|why| why.to_string().trim().to_owned())?;
        map.check()?;
        Ok(map)
    }

    /// The map that ships whose columns a recording has, if one's gyro and time are there.
    pub fn by_columns(recording: &Recording) -> Option<Self> {
        let has = |name: &str| {
            recording.groups.iter().flat_map(|group| &group.columns).any(|column| column.name == name)
        };
        let fits = |map: &Self| {
            let gyro = map.gyro.iter().flat_map(|gyro| &gyro.columns);
            let time = map.time.as_ref().and_then(|time| time.column.as_deref());
            time.is_none_or(has)
                && gyro.into_iter().all(|source| matches!(source, Source::Column(name) if has(name)))
        };
        SHIPPED.iter().filter_map(|(_, text)| Self::parse(text).ok()).find(fits)
    }

    /// The sensors that it names, in the order of [`Sensor::ALL`].
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

    fn check(&self) -> Result<(), String> {
        if let Some(time) = &self.time {
            Quantity::Time.factor(time.unit.as_deref()).map_err(|why| format!("time: {why}"))?;
            match (&time.column, time.rate_hz) {
                (Some(_), None) => {}
                (None, Some(rate_hz)) if (0.01..=1e5).contains(&rate_hz) => {}
                (None, Some(rate_hz)) => {
                    return Err(format!("time: rate_hz = {rate_hz} is outside 0.01 to 100000"));
                }
                _ => return Err("time: either column or rate_hz must be there".into()),
            }
        }
        for Mapped { sensor, signal } in self.sensors() {
            let key = sensor.name().replace('-', "_");
            signal.check(axes_of(sensor), quantity_of(sensor)).map_err(|why| format!("{key}: {why}"))?;
        }
        let References { roll, torque } = &self.reference;
        for (key, signal, quantity) in [("roll", roll, Quantity::Angle), ("torque", torque, Quantity::Torque)]
        {
            let checked = signal.as_ref().map_or(Ok(()), |signal| signal.check(1, quantity));
            checked.map_err(|why| format!("reference.{key}: {why}"))?;
        }
        Ok(())
    }
}

/// How many columns a sensor has.
pub(super) fn axes_of(sensor: Sensor) -> usize {
    sensor.axes().len().max(1)
}

/// What a sensor measures; the path's lateral error is a length beside the heading's angle.
pub(super) const fn quantity_of(sensor: Sensor) -> Quantity {
    match sensor {
        Sensor::Gyro | Sensor::SteerRate => Quantity::Rate,
        Sensor::Accel => Quantity::Force,
        Sensor::Steer | Sensor::Path => Quantity::Angle,
        Sensor::FrontWheel | Sensor::RearWheel => Quantity::Speed,
        Sensor::RiderTorque | Sensor::MotorReport => Quantity::Torque,
    }
}

impl Signal {
    fn check(&self, axes: usize, quantity: Quantity) -> Result<(), String> {
        if self.columns.len() != axes {
            return Err(format!("columns: {} are named, it has {axes}", self.columns.len()));
        }
        quantity.factor(self.unit.as_deref())?;
        let in_range = |key: &str, value: f64, most: f64| {
            let good = value.abs() <= most;
            good.then_some(()).ok_or(format!("{key} = {value} is outside -{most} to {most}"))
        };
        in_range("scale", self.scale, 1e6)?;
        if self.scale == 0.0 {
            return Err("scale = 0 leaves nothing of the column".into());
        }
        in_range("offset", self.offset, 1e6)?;
        if !(0.0..=1.0).contains(&self.late_s) {
            return Err(format!("late_s = {} is outside 0 to 1", self.late_s));
        }
        match (&self.axes, axes) {
            (Some(axes), 3) => turned(axes).map(drop),
            (Some(_), _) => Err("axes: only a sensor of three axes can be turned".into()),
            (None, _) => Ok(()),
        }
    }

    /// Which of its own axes, and with what sign, points along each of the bicycle's.
    pub(super) fn turns(&self) -> [(usize, f64); 3] {
        let straight = [(0, 1.0), (1, 1.0), (2, 1.0)];
        self.axes.as_ref().and_then(|axes| turned(axes).ok()).unwrap_or(straight)
    }
}

/// The places and signs of `["-y", "x", "z"]`.
fn turned(axes: &[String; 3]) -> Result<[(usize, f64); 3], String> {
    let one = |word: &String| {
        let (sign, letter) = word.strip_prefix('-').map_or((1.0, word.as_str()), |letter| (-1.0, letter));
        let place = ["x", "y", "z"].iter().position(|axis| *axis == letter);
        place.map(|place| (place, sign)).ok_or(format!("axes: `{word}` is none of x, y, z, -x, -y, -z"))
    };
    let [x, y, z] = axes;
    let turns = [one(x)?, one(y)?, one(z)?];
    // Each once, and right-handed: a mirrored sensor is a wrong map.
    let [a, b, c] = turns;
    let even = [(0, 1, 2), (1, 2, 0), (2, 0, 1)].contains(&(a.0, b.0, c.0));
    let odd = [(0, 2, 1), (2, 1, 0), (1, 0, 2)].contains(&(a.0, b.0, c.0));
    let signs = a.1 * b.1 * c.1;
    match (even, odd) {
        (false, false) => Err(format!("axes: {axes:?} names an axis twice")),
        (true, _) if signs > 0.0 => Ok(turns),
        (_, true) if signs < 0.0 => Ok(turns),
        _ => Err(format!("axes: {axes:?} is a mirror image, which no way of mounting is; change a sign")),
    }
}
