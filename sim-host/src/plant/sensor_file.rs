//! Models of real sensors, as `sim-host identify sensor` writes them: numbers in SI units, whatever the control period is.

use super::{FittedErrors, PlantError, Sensor, SensorConfig, SensorModel};
use crate::range::within;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The models that ship, by name.
pub const SHIPPED: [(&str, &str); 7] = [
    ("encoders-robot", include_str!("../../../data/sensors/encoders-robot.toml")),
    ("fused-imu-can", include_str!("../../../data/sensors/fused-imu-can.toml")),
    ("hall-16", include_str!("../../../data/sensors/hall-16.toml")),
    ("mpu6050-robot", include_str!("../../../data/sensors/mpu6050-robot.toml")),
    ("steer-lws", include_str!("../../../data/sensors/steer-lws.toml")),
    ("wheel-can", include_str!("../../../data/sensors/wheel-can.toml")),
    ("wheel-sbw", include_str!("../../../data/sensors/wheel-sbw.toml")),
];

/// What leaves every sensor as it is, beside the names of [`SHIPPED`].
pub const EXACT: &str = "exact";

/// A file of models: one table for each kind of sensor.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct SensorFile {
    /// Which sensors they are, and where their recordings are from.
    pub source: String,
    /// The recordings' licence.
    pub licence: String,
    /// The command that wrote the file.
    pub command: String,
    /// Rate gyroscope \[rad/s\].
    pub gyro: Option<SensorNumbers>,
    /// Accelerometer \[m/s^2\].
    pub accel: Option<SensorNumbers>,
    /// Steer angle \[rad\].
    pub steer: Option<SensorNumbers>,
    /// Steer rate \[rad/s\].
    pub steer_rate: Option<SensorNumbers>,
    /// Speed of either wheel \[m/s\].
    pub wheel: Option<SensorNumbers>,
    /// Torque of the rider \[N m\].
    pub rider_torque: Option<SensorNumbers>,
    /// The drive's report of its torque \[N m\].
    pub motor_report: Option<SensorNumbers>,
}

/// The numbers of one sensor; what is left out is exact. Those by axis have as many values as the sensor has axes, in
/// the sensor's unit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SensorNumbers {
    /// Time between samples \[s\].
    pub period_s: Option<f64>,
    /// How much later than the whole multiples of the period samples are taken \[s\].
    pub phase_s: Option<f64>,
    /// Random lateness: of 99 in 100 samples at most, and the worst \[s\].
    pub jitter_s: Option<[f64; 2]>,
    /// Time from the measurement to its arrival \[s\].
    pub delay_s: Option<f64>,
    /// A sample is the mean over this time \[s\].
    pub window_s: Option<f64>,
    /// Pulses in a turn of the wheel.
    pub pulses_per_turn: Option<u16>,
    /// Probability that a sample repeats the one before.
    pub repeat: Option<f64>,
    /// Step between values, by axis.
    pub quantum: Vec<f64>,
    /// One-sided density of the white noise, by axis \[unit/Hz^0.5\].
    pub white_density: Vec<f64>,
    /// Random walk of the bias, by axis \[unit/s^0.5\].
    pub walk: Vec<f64>,
    /// Standard deviation of the bias from ride to ride, by axis.
    pub bias_spread: Vec<f64>,
    /// Root mean square of the vibration in the octaves from 10, 20, 40 and 80 Hz, by axis, for 1 m/s of speed.
    pub vibration: Vec<[f64; 4]>,
    /// What was measured, with intervals; for people.
    pub measured: Vec<MeasuredNumber>,
    /// What the recordings can't tell, and why.
    pub left_out: Vec<String>,
}

/// A measured number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeasuredNumber {
    /// What it is.
    pub number: String,
    /// Of which axis; empty if of all, or of the only one.
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
    /// How long a recording it comes from \[s\].
    pub seconds: f64,
}

/// A sensor's table in a file.
pub const fn table_of(sensor: Sensor) -> &'static str {
    match sensor {
        Sensor::FrontWheel | Sensor::RearWheel => "wheel",
        other => other.name(),
    }
}

impl SensorFile {
    /// The models of a shipped name, or of a file.
    ///
    /// # Errors
    /// No such name or file, a key that is missing, unknown or of a wrong type, or a value out of range: each named.
    pub fn load(name: &str) -> Result<Self, PlantError> {
        if let Some((_, text)) = SHIPPED.iter().find(|(shipped, _)| *shipped == name) {
            return Self::parse(text).map_err(|error| PlantError(format!("sensor model {name}: {error}")));
        }
        if !Path::new(name).exists() {
            let names: Vec<_> = SHIPPED.iter().map(|(shipped, _)| *shipped).collect();
            let names = names.join(", ");
            let error =
                format!("unknown sensor model `{name}`: no such file, and not one of {EXACT}, {names}");
            return Err(PlantError(error));
        }
        let text = std::fs::read_to_string(name)
            .map_err(|e| PlantError(format!("can't read the sensor model {name}: {e}")))?;
        Self::parse(&text).map_err(|error| PlantError(format!("sensor model {name}: {error}")))
    }

    /// The models in a text.
    ///
    /// # Errors
    /// Names the key, its value and what was expected.
    pub fn parse(text: &str) -> Result<Self, String> {
        let file: Self = toml::from_str(text).map_err(|e| e.to_string().trim().to_owned())?;
        for (sensor, numbers) in file.tables() {
            numbers.check(sensor).map_err(|error| format!("{}: {error}", table_of(sensor)))?;
        }
        Ok(file)
    }

    /// The table of a sensor, if there is one.
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

    /// The table of a sensor, to be set; none where a file has none for it.
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

    /// Every sensor that has a table; both wheels have the same.
    pub fn tables(&self) -> impl Iterator<Item = (Sensor, &SensorNumbers)> {
        Sensor::ALL.into_iter().filter_map(|sensor| Some((sensor, self.of(sensor)?)))
    }

    /// Makes every sensor with a table the one of the file, in control periods of `period_s`.
    ///
    /// # Errors
    /// Names the time that is too long.
    pub fn apply(&self, sensors: &mut SensorConfig, period_s: f64) -> Result<(), String> {
        self.tables().try_for_each(|(sensor, numbers)| {
            *sensors.model_mut(sensor) = numbers.model(period_s)?;
            Ok(())
        })
    }
}

impl SensorNumbers {
    fn check(&self, sensor: Sensor) -> Result<(), String> {
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
            return Err("white_density: there is no period_s beside it".into());
        }
        // What is too long or does not fit the sensor shows once it is counted in control periods, here of 1 ms.
        self.model(1e-3)?.check(sensor).map_err(|e| e.0)
    }

    /// The model, times rounded to control periods of `period_s`.
    ///
    /// # Errors
    /// Names the time that is too long.
    pub fn model(&self, period_s: f64) -> Result<SensorModel, String> {
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
            // Up to half the sample rate.
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

fn axes_of(key: &str, there: usize, axes: usize) -> Result<(), String> {
    let fits = there == 0 || there == axes;
    fits.then_some(()).ok_or_else(|| format!("{key} has {there} values, the sensor {axes}"))
}

/// The values by axis, nothing where there is none.
fn padded<T: Copy + Default>(values: &[T]) -> [T; 3] {
    std::array::from_fn(|axis| values.get(axis).copied().unwrap_or_default())
}
