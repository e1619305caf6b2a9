//! Files of fitted sensor models, as written by `sim-host identify sensor`: numbers in SI units, independent
//! of the control period.

use super::{FittedErrors, PlantError, Sensor, SensorConfig, SensorModel};
use crate::range::{RangeError, within};
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};
use std::path::Path;

/// The shipped models, by name.
pub const SHIPPED: [(&str, &str); 7] = [
    ("encoders-robot", include_str!("../../../../data/sensors/encoders-robot.toml")),
    ("fused-imu-can", include_str!("../../../../data/sensors/fused-imu-can.toml")),
    ("hall-16", include_str!("../../../../data/sensors/hall-16.toml")),
    ("mpu6050-robot", include_str!("../../../../data/sensors/mpu6050-robot.toml")),
    ("steer-lws", include_str!("../../../../data/sensors/steer-lws.toml")),
    ("wheel-can", include_str!("../../../../data/sensors/wheel-can.toml")),
    ("wheel-sbw", include_str!("../../../../data/sensors/wheel-sbw.toml")),
];

/// Name of the exact sensors, in addition to the names in [`SHIPPED`].
pub const EXACT: &str = "exact";

/// A file of models: one table for each type of sensor.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct SensorFile {
    /// Sensor products and origin of their recordings.
    pub source: String,
    /// The recordings' licence.
    pub licence: String,
    /// Command that wrote the file.
    pub command: String,
    /// Rate gyroscope \[rad/s\].
    pub gyro: Option<SensorNumbers>,
    /// Accelerometer \[m/s^2\].
    pub accel: Option<SensorNumbers>,
    /// Steer angle \[rad\].
    pub steer: Option<SensorNumbers>,
    /// Steer rate \[rad/s\].
    pub steer_rate: Option<SensorNumbers>,
    /// Forward speed from either wheel \[m/s\].
    pub wheel: Option<SensorNumbers>,
    /// Torque of the rider \[N m\].
    pub rider_torque: Option<SensorNumbers>,
    /// Torque that the drive reports \[N m\].
    pub motor_report: Option<SensorNumbers>,
}

/// An array of exactly `N` numbers: toml 1.2 reads one of fixed length from a longer one.
struct Exactly<const N: usize>([f64; N]);

impl<'de, const N: usize> Deserialize<'de> for Exactly<N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let numbers = Vec::<f64>::deserialize(deserializer)?;
        let count = numbers.len();
        let exactly = numbers.try_into().map(Self);
        exactly.map_err(|_| Error::invalid_length(count, &format!("{N} numbers").as_str()))
    }
}

fn pair<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<[f64; 2]>, D::Error> {
    Ok(Option::<Exactly<2>>::deserialize(deserializer)?.map(|pair| pair.0))
}

fn octaves<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<[f64; 4]>, D::Error> {
    Ok(Vec::<Exactly<4>>::deserialize(deserializer)?.into_iter().map(|octaves| octaves.0).collect())
}

/// Numbers of one sensor; omitted ones are exact. Numbers by axis have as many values as the sensor has axes,
/// in the sensor's unit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SensorNumbers {
    /// Time between samples \[s\].
    pub period_s: Option<f64>,
    /// Offset of the sampling instants from the whole multiples of the period \[s\].
    pub phase_s: Option<f64>,
    /// Random delay \[s\]: largest of 99 in 100 samples, and largest of all.
    #[serde(deserialize_with = "pair")]
    pub jitter_s: Option<[f64; 2]>,
    /// Time from the measurement to its arrival \[s\].
    pub delay_s: Option<f64>,
    /// A sample is the mean over this time \[s\].
    pub window_s: Option<f64>,
    /// Pulses per turn of the wheel.
    pub pulses_per_turn: Option<u16>,
    /// Probability that a sample repeats the previous one.
    pub repeat: Option<f64>,
    /// Quantisation step, by axis.
    pub quantum: Vec<f64>,
    /// One-sided density of the white noise, by axis \[unit/Hz^0.5\].
    pub white_density: Vec<f64>,
    /// Random walk of the bias, by axis \[unit/s^0.5\].
    pub walk: Vec<f64>,
    /// Standard deviation of the bias from ride to ride, by axis.
    pub bias_spread: Vec<f64>,
    /// Root mean square of the vibration in the octaves from 10, 20, 40 and 80 Hz, by axis, per 1 m/s of
    /// speed.
    #[serde(deserialize_with = "octaves")]
    pub vibration: Vec<[f64; 4]>,
    /// Measured numbers with intervals, for information only.
    pub measured: Vec<MeasuredNumber>,
    /// Quantities that the recordings do not determine, with the reason.
    pub left_out: Vec<String>,
}

/// A measured number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeasuredNumber {
    /// Name of the quantity.
    pub number: String,
    /// Axis; empty for all axes, or for the only one.
    #[serde(default)]
    pub axis: String,
    /// Its unit.
    pub unit: String,
    /// The number.
    pub value: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Duration of the recording used \[s\].
    pub seconds: f64,
}

/// Name of a sensor's table in a file.
pub const fn table_of(sensor: Sensor) -> &'static str {
    match sensor {
        Sensor::FrontWheel | Sensor::RearWheel => "wheel",
        other => other.name(),
    }
}

/// The names of the tables that a file can have.
fn tables() -> Vec<&'static str> {
    let mut file = SensorFile::default();
    let known = Sensor::ALL.into_iter().filter(|sensor| file.of_mut(*sensor).is_some());
    let mut names: Vec<_> = known.map(table_of).collect();
    names.dedup();
    names
}

/// Sensor models that can't be loaded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SensorFileError {
    /// Neither a shipped name nor a file.
    #[error("unknown sensor model `{0}`: no such file, and not one of {EXACT}, {known}", known = shipped())]
    Unknown(String),
    /// The file can't be read.
    #[error("can't read the sensor model {name}: {error}")]
    Read {
        /// The file.
        name: String,
        /// The system's error.
        error: String,
    },
    /// Its content is wrong.
    #[error("sensor model {name}: {error}")]
    Content {
        /// Name or file.
        name: String,
        /// The error.
        error: SensorTextError,
    },
}

fn shipped() -> String {
    SHIPPED.map(|(name, _)| name).join(", ")
}

/// Text that is no file of sensor models.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SensorTextError {
    /// Not TOML, or a key is missing, unknown or of a wrong type: the parser's message.
    #[error("{0}")]
    Syntax(String),
    /// No table of a sensor.
    #[error("there is no sensor in it; expected a table of one or more of {}", tables().join(", "))]
    Empty,
    /// A wrong number in a table.
    #[error("{table}: {error}")]
    Table {
        /// The table.
        table: &'static str,
        /// The error.
        error: SensorNumberError,
    },
}

/// A wrong number of a sensor model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SensorNumberError {
    /// A value outside its range.
    #[error(transparent)]
    Range(#[from] RangeError),
    /// Numbers that are no model.
    #[error(transparent)]
    Model(#[from] PlantError),
    /// More or fewer values than axes.
    #[error("{key} has {values} values, the sensor {axes}")]
    Axes {
        /// The key.
        key: &'static str,
        /// Number of values.
        values: usize,
        /// Number of axes.
        axes: usize,
    },
    /// A density of noise without a time between samples.
    #[error("white_density: there is no period_s beside it")]
    NoPeriod,
}

impl SensorFile {
    /// Loads the models by shipped name, or from a file.
    ///
    /// # Errors
    /// An unknown name or file, a missing or unknown key, a wrong type, or a value out of range; each is
    /// named.
    pub fn load(name: &str) -> Result<Self, SensorFileError> {
        let content = |error| SensorFileError::Content { name: name.into(), error };
        if let Some((_, text)) = SHIPPED.iter().find(|(shipped, _)| *shipped == name) {
            return Self::parse(text).map_err(content);
        }
        if !Path::new(name).exists() {
            return Err(SensorFileError::Unknown(name.into()));
        }
        let text = crate::input_file::text(Path::new(name))
            .map_err(|e| SensorFileError::Read { name: name.into(), error: e.to_string() })?;
        Self::parse(&text).map_err(content)
    }

    /// Parses models from text.
    ///
    /// # Errors
    /// The key, its value and the expected form.
    pub fn parse(text: &str) -> Result<Self, SensorTextError> {
        let file: Self =
            toml::from_str(text).map_err(|e| SensorTextError::Syntax(e.to_string().trim().into()))?;
        if file.tables().next().is_none() {
            return Err(SensorTextError::Empty);
        }
        for (sensor, numbers) in file.tables() {
            let wrong = |error| SensorTextError::Table { table: table_of(sensor), error };
            numbers.check(sensor).map_err(wrong)?;
        }
        Ok(file)
    }

    /// The table of a sensor, if the file has one.
    pub fn of(&self, sensor: Sensor) -> Option<&SensorNumbers> {
        match sensor {
            Sensor::Gyro => self.gyro.as_ref(),
            Sensor::Accel => self.accel.as_ref(),
            Sensor::Steer => self.steer.as_ref(),
            Sensor::SteerRate => self.steer_rate.as_ref(),
            Sensor::FrontWheel | Sensor::RearWheel => self.wheel.as_ref(),
            Sensor::RiderTorque => self.rider_torque.as_ref(),
            Sensor::MotorReport => self.motor_report.as_ref(),
            Sensor::Path => None,
        }
    }

    /// The table of a sensor, mutable; none for sensors that files do not describe.
    pub fn of_mut(&mut self, sensor: Sensor) -> Option<&mut Option<SensorNumbers>> {
        match sensor {
            Sensor::Gyro => Some(&mut self.gyro),
            Sensor::Accel => Some(&mut self.accel),
            Sensor::Steer => Some(&mut self.steer),
            Sensor::SteerRate => Some(&mut self.steer_rate),
            Sensor::FrontWheel | Sensor::RearWheel => Some(&mut self.wheel),
            Sensor::RiderTorque => Some(&mut self.rider_torque),
            Sensor::MotorReport => Some(&mut self.motor_report),
            Sensor::Path => None,
        }
    }

    /// Every sensor that has a table; both wheels share one.
    pub fn tables(&self) -> impl Iterator<Item = (Sensor, &SensorNumbers)> {
        Sensor::ALL.into_iter().filter_map(|sensor| Some((sensor, self.of(sensor)?)))
    }

    /// Replaces every sensor that has a table by its model, with control periods of `period_s`.
    ///
    /// # Errors
    /// States the time that is too long.
    pub fn apply(&self, sensors: &mut SensorConfig, period_s: f64) -> Result<(), RangeError> {
        self.tables().try_for_each(|(sensor, numbers)| {
            *sensors.model_mut(sensor) = numbers.model(period_s)?;
            Ok(())
        })
    }
}

impl SensorNumbers {
    fn check(&self, sensor: Sensor) -> Result<(), SensorNumberError> {
        let axes = sensor.axes().len().max(1);
        let optional =
            |key: &str, value: Option<f64>, min, max| value.map_or(Ok(()), |x| within(key, x, min, max));
        optional("period_s", self.period_s, 1e-4, 1.0)?;
        optional("phase_s", self.phase_s, 0.0, 1.0)?;
        for x in self.jitter_s.iter().flatten() {
            within("jitter_s", *x, 0.0, 5.0)?;
        }
        optional("delay_s", self.delay_s, 0.0, 1.0)?;
        optional("window_s", self.window_s, 0.0, 10.0)?;
        optional("repeat", self.repeat, 0.0, 0.999)?;
        let by_axis = [
            ("quantum", &self.quantum),
            ("white_density", &self.white_density),
            ("walk", &self.walk),
            ("bias_spread", &self.bias_spread),
        ];
        for (key, values) in by_axis {
            axes_of(key, values.len(), axes)?;
            values.iter().try_for_each(|x| within(key, *x, 0.0, 1e3))?;
        }
        axes_of("vibration", self.vibration.len(), axes)?;
        self.vibration.iter().flatten().try_for_each(|x| within("vibration", *x, 0.0, 1e3))?;
        if self.period_s.is_none() && !self.white_density.is_empty() {
            return Err(SensorNumberError::NoPeriod);
        }
        // Times too long or unsuited to the sensor show only in control periods, here of 1 ms.
        Ok(self.model(1e-3)?.check(sensor)?)
    }

    /// The model, with times rounded to control periods of `period_s`.
    ///
    /// # Errors
    /// States the time that is too long.
    pub fn model(&self, period_s: f64) -> Result<SensorModel, RangeError> {
        let ticks = |key: &str, time_s: f64| {
            let ticks = (time_s / period_s).round();
            within(&format!("{key} (control periods)"), ticks, 0.0, 1e4).map(|()| ticks as u16)
        };
        let optional = |key: &str, time_s: Option<f64>| time_s.map_or(Ok(0), |time_s| ticks(key, time_s));
        let every_ticks = optional("period_s", self.period_s)?.max(1);
        let sample_s = f64::from(every_ticks) * period_s;
        let [most_s, worst_s] = self.jitter_s.unwrap_or_default();
        let fitted = FittedErrors {
            phase_ticks: optional("phase_s", self.phase_s)?,
            jitter_ticks: [ticks("jitter_s", most_s)?, ticks("jitter_s", worst_s)?],
            window_ticks: optional("window_s", self.window_s)?,
            pulses_per_turn: self.pulses_per_turn.unwrap_or(0),
            // Noise bandwidth: half the sample rate.
            white: padded(&self.white_density).map(|density| density * (0.5 / sample_s).sqrt()),
            walk: padded(&self.walk),
            bias_spread: padded(&self.bias_spread),
            vibration: padded(&self.vibration),
            quantum: padded(&self.quantum),
            repeat: self.repeat.unwrap_or(0.0),
        };
        let delay_ticks = optional("delay_s", self.delay_s)?;
        Ok(SensorModel { every_ticks, delay_ticks, fitted, ..SensorModel::default() })
    }
}

fn axes_of(key: &'static str, values: usize, axes: usize) -> Result<(), SensorNumberError> {
    let fits = values == 0 || values == axes;
    fits.then_some(()).ok_or(SensorNumberError::Axes { key, values, axes })
}

/// Values by axis, padded with zeros.
fn padded<T: Copy + Default>(values: &[T]) -> [T; 3] {
    std::array::from_fn(|axis| values.get(axis).copied().unwrap_or_default())
}
